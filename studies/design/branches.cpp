#include "studies/design/branches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <optional>

#include "render/base/error.h"
#include "render/setup/setup_node.h"
#include "studies/case/uncertain_inputs.h"
#include "studies/design/sheet.h"

namespace gladstone::inline design {
namespace {

constexpr std::array<char const*, 4> question_tables{"requirements", "limits", "inventory", "free"};

SetupNode prescription_node(std::string const& file) {
  SetupNode lens;
  lens.members.push_back({"model", setup_text("prescription")});
  lens.members.push_back({"file", setup_text(file)});
  return lens;
}

/// Returns why the closed forms do not apply to a setup, with the key concerned; empty if they do.
std::pair<std::string, std::string> beyond_design(Setup const& setup) {
  if (!setup.experiment().measures_density) {
    return {"experiment", "is not \"bos\" (requirements apply to BOS set-ups)"};
  }
  if (setup.lens.focus != Focus::target) {
    return {"lens.focus", "is not on the target (the formulas describe dots in focus); use focus = \"target\""};
  }
  if (setup.pose || setup.camera.tilted() || !setup.elements.empty()) {
    return {"camera",
            "is posed, tilted, or has optical elements besides the lens (requirements assume a camera on the axis, "
            "perpendicular to the target); remove these from the setup"};
  }
  if (!std::isfinite(setup.lens.f_number)) {
    return {"lens.f_number", "does not define an aperture (a design requires the light cone); give a number"};
  }
  return {};
}

bool chooses_dots(DesignQuestion const& question) {
  return std::any_of(question.free.begin(), question.free.end(),
                     [](FreeChoice const& free) { return free.choice == Choice::dot_diameter; });
}

/// Returns a setup that is valid for any camera and lens: minimizes dot diameters that are design variables, so that
/// they do not cover the target.
SetupDocument with_small_dots(SetupDocument document) {
  constexpr double small_px = 1, small_mm = 1e-3;
  if (document.find({"target", "dot_diameter_mm"})) {
    document.set({"target", "dot_diameter_mm"}, setup_number(small_mm));
  } else {
    document.set({"target", "dot_diameter_px"}, setup_number(small_px));
  }
  return document;
}

/// Loads a setup, with small dots if their diameter is a design variable.
CaseSetup load_with_small_dots(SetupDocument const& document, DesignQuestion const& question) {
  return load_case_setup(chooses_dots(question) ? with_small_dots(document.copy()) : document.copy());
}

DesignVariant make_variant(SetupDocument document, CaseSetup const& loaded, std::string const& camera,
                           std::string const& lens) {
  if (auto const [key, reason] = beyond_design(loaded.setup); !key.empty()) {
    auto const dot = key.find('.');
    SetupTable table = dot == std::string::npos ? document.root() : document.root().table(key.substr(0, dot));
    throw SetupError({{table.where(dot == std::string::npos ? key : key.substr(dot + 1)), key + ' ' + reason}});
  }
  auto given = std::make_unique<FixedDesignParameters>(collect_fixed_parameters(loaded));
  return {camera, lens, std::move(document), loaded.setup, std::move(given)};
}

/// Returns the values of a design variable in a variant: the discrete ones, or the given one; empty: an interval.
std::vector<double> values_of(FreeChoice const& free, DesignVariant const& variant) {
  if (variant.lens.empty() || free.choice == Choice::z_a || free.choice == Choice::z_d) return free.values;
  if (free.choice == Choice::focal_length) return {variant.setup.lens.focal_length};
  std::vector<double> values = free.values;
  if (free.choice == Choice::f_number) {  // exclude f-numbers below that of the prescription's own stop
    std::erase_if(values, [&](double value) { return value < variant.setup.lens.f_number * (1 - 1e-6); });
  }
  return values;
}

std::string parts_name(std::string const& camera, std::string const& lens) {
  std::string name;
  for (std::string const& file : {camera, lens}) {
    if (!file.empty()) name += (name.empty() ? "" : ", ") + std::filesystem::path(file).filename().string();
  }
  return name;
}

}  // namespace

std::vector<DesignVariant> design_variants(SetupDocument const& document, DesignQuestion const& question,
                                           std::vector<SkippedVariant>& skipped, CaseSetup const* loaded) {
  std::vector<DesignVariant> variants;
  std::exception_ptr first;
  auto const add = [&](SetupDocument const& with_both, std::string const& camera, std::string const& lens) {
    try {
      bool const known = loaded && camera.empty() && lens.empty() && !chooses_dots(question);
      std::optional<CaseSetup> own;
      if (!known) own = load_with_small_dots(with_both, question);
      variants.push_back(make_variant(with_both.copy(), known ? *loaded : *own, camera, lens));
    } catch (SetupError const& error) {
      if (camera.empty() && lens.empty()) throw;  // the setup itself is invalid
      if (!first) first = std::current_exception();
      skipped.push_back({camera, lens, error.what()});
    }
  };
  std::size_t const cameras = std::max<std::size_t>(1, question.cameras.size());
  for (std::size_t i = 0; i < cameras; ++i) {
    SetupDocument with_camera = document.copy();
    std::string name;
    if (!question.cameras.empty()) {
      with_camera.set({"camera"}, question.cameras[i].table);
      name = question.cameras[i].file;
    }
    add(with_camera, name, "");
    for (std::string const& lens : question.lenses) {
      SetupDocument with_lens = with_camera.copy();
      with_lens.set({"lens"}, prescription_node(lens));
      add(with_lens, name, lens);
    }
  }
  if (variants.empty()) std::rethrow_exception(first);
  return variants;
}

std::vector<DesignBranch> design_branches(std::vector<DesignVariant> const& variants, DesignQuestion const& question) {
  std::vector<DesignBranch> branches;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    Setup const& setup = variants[i].setup;
    DesignBranch first;
    first.given = variants[i].given.get();
    first.variant = i;
    first.value = {setup.lens.focal_length, setup.lens.f_number, setup.z_a, setup.z_d, setup.dot_diameter()};
    if (!setup.target.dot_diameter_m) first.dot_px = setup.target.dot_diameter_px;
    std::vector<DesignBranch> combined{first};
    for (FreeChoice const& free : question.free) {
      if (free.choice == Choice::dot_diameter) {
        for (DesignBranch& branch : combined) branch.dot_px.reset();
      }
      std::vector<double> const values = values_of(free, variants[i]);
      if (values.empty() && free.values.empty()) {
        for (DesignBranch& branch : combined) branch.continuous.push_back(free);
        continue;
      }
      std::vector<DesignBranch> more;
      for (DesignBranch const& branch : combined) {
        for (double const value : values) {
          more.push_back(branch);
          more.back().value[static_cast<std::size_t>(free.choice)] = value;
        }
      }
      combined = std::move(more);
    }
    branches.insert(branches.end(), combined.begin(), combined.end());
  }
  return branches;
}

std::string SkippedVariant::name() const { return parts_name(camera, lens); }

std::string branch_name(DesignBranch const& branch, std::vector<DesignVariant> const& variants,
                        DesignQuestion const& question) {
  DesignVariant const& variant = variants[branch.variant];
  std::string name = parts_name(variant.camera, variant.lens);
  auto const add = [&name](std::string const& part) { name += (name.empty() ? "" : ", ") + part; };
  for (FreeChoice const& free : question.free) {
    bool const continuous = std::any_of(branch.continuous.begin(), branch.continuous.end(),
                                        [&free](FreeChoice const& other) { return other.choice == free.choice; });
    if (continuous) continue;
    ChoiceKey const& key = choice_key(free.choice);
    add(fmt::format("{} = {:.6g}", key.limit, branch.value[static_cast<std::size_t>(free.choice)] / key.unit));
  }
  return name.empty() ? "the setup" : name;
}

SetupDocument applied_setup(DesignVariant const& variant, DesignQuestion const& question,
                            DesignPoint<double> const& bench) {
  SetupDocument document = variant.document.copy();
  std::array<double, choice_count> const value{bench.focal_length, bench.f_number, bench.z_a, bench.z_d,
                                               bench.dot_diameter};
  // remove the other key of the dot diameter
  if (chooses_dots(question)) document.remove({"target", "dot_diameter_px"});
  for (FreeChoice const& free : question.free) {
    if (free.choice == Choice::focal_length && !variant.lens.empty()) continue;
    ChoiceKey const& key = choice_key(free.choice);
    std::string const path = key.path;
    auto const dot = path.find('.');
    document.set({path.substr(0, dot), path.substr(dot + 1)},
                 setup_number(value[static_cast<std::size_t>(free.choice)] / key.unit));
  }
  // Load the setup: verifies that it can be rendered, and makes its file names absolute.
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  SetupDocument applied = std::move(load_case_setup(std::move(document)).document);
  insert_uncertain_inputs(applied, uncertain);
  for (char const* const table : question_tables) applied.remove({table});
  return applied.unread();
}

}  // namespace gladstone::inline design
