#include "studies/sweep/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>

#include "analysis/correlation_settings.h"
#include "render/base/content_hash.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/output_file.h"
#include "render/base/partial.h"
#include "render/base/random.h"
#include "render/base/sobol.h"
#include "render/base/text_file.h"
#include "studies/case.h"
#include "studies/sweep/claims.h"
#include "studies/sweep/results.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// TOML's whole numbers have 63 bits.
std::uint64_t case_seed(StudyFile const& study, std::size_t repeat) {
  return repeat == 0 ? study.seed : repeat_seed(study.seed, repeat) >> 1;
}

/// Whether the axes' values hold something at a path of keys, by itself or in a table above it.
bool axes_give(StudyFile const& study, std::vector<AxisValue> const& values, std::vector<std::string> const& path) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::vector<std::string> const& above = study.axes[k].path;
    if (above.size() > path.size() || !std::equal(above.begin(), above.end(), path.begin())) continue;
    SetupNode const* node = &values[k].node;
    for (std::size_t i = above.size(); node && i < path.size(); ++i) node = node->find(path[i]);
    if (node) return true;
  }
  return false;
}

/// The base with the axes' values and, where they give none, the seeds put in.
SetupDocument compose(StudyFile const& study, std::vector<AxisValue> const& values, std::uint64_t seed) {
  SetupDocument document =
      SetupDocument::from_text(study.base_text, study.base_path, fs::path(study.base_path).parent_path().string());
  for (std::size_t k = 0; k < values.size(); ++k) document.set(study.axes[k].path, values[k].node);
  SetupNode number;
  number.kind = SetupNode::Kind::integer;
  number.integer = static_cast<long long>(seed);
  number.place = study.place;
  std::vector<std::vector<std::string>> const seeds{
      {"target", "seed"}, {"render", "seed"}, {"camera", "noise", "seed"}};
  for (std::vector<std::string> const& path : seeds) {
    if (axes_give(study, values, path)) continue;
    SetupNode const* const table = document.find({path.begin(), path.end() - 1});
    if (!table && path.size() > 2) continue;  // noise that nobody asked for
    // what should be a table and is none is told when the setup is read
    if (table && table->kind != SetupNode::Kind::table && table->kind != SetupNode::Kind::array) continue;
    document.set(path, number);
  }
  return document;
}

/// Values of all axes at a point of the study.
std::vector<AxisValue> values_at(StudyFile const& study, std::size_t point) {
  std::vector<AxisValue> values(study.axes.size());
  std::size_t rest = point;
  for (std::size_t k = values.size(); k-- > 0;) {
    AxisPlan const& axis = study.axes[k];
    if (study.mode == StudyMode::zip) {
      values[k] = axis.value(point);
    } else if (study.mode == StudyMode::grid) {
      values[k] = axis.value(rest % axis.size());
      rest /= axis.size();
    } else {
      auto const scrambling = static_cast<std::uint32_t>(mix64(study.seed + 0x9e3779b97f4a7c15ULL * (k + 1)));
      std::uint32_t const bits = sobol_bits(static_cast<std::uint32_t>(point), static_cast<int>(k));
      values[k] = axis.value_at(owen_scramble(bits, scrambling) * 0x1p-32);
    }
  }
  return values;
}

/// The points that between them take every value of every axis (of a sampled range: its ends and a sample).
std::vector<std::vector<AxisValue>> points_to_try(StudyFile const& study) {
  std::vector<std::vector<AxisValue>> points;
  if (study.mode == StudyMode::zip) {
    for (std::size_t point = 0; point < study.points(); ++point) points.push_back(values_at(study, point));
    return points;
  }
  std::vector<AxisValue> first;
  for (AxisPlan const& axis : study.axes) first.push_back(axis.value(0));
  points.push_back(first);
  for (std::size_t k = 0; k < study.axes.size(); ++k) {
    AxisPlan const& axis = study.axes[k];
    bool const sampled = study.mode == StudyMode::sobol && axis.range;
    for (std::size_t i = sampled ? std::max<std::size_t>(axis.size(), 2) - 1 : 1; i < axis.size(); ++i) {
      points.push_back(first);
      points.back()[k] = axis.value(i);
    }
    if (sampled) {
      points.push_back(first);
      points.back()[k] = values_at(study, 0)[k];
    }
  }
  return points;
}

std::string where(StudyFile const& study, SetupPlace const& place) {
  return fmt::format("{}:{}:{}", study.path, place.line, place.column);
}

/// A key that nobody knows is the axis's mistake, not its values'; whole numbers are not what a range is sampled by.
void blame_the_axis(StudyFile const& study, std::vector<AxisValue> const& values, SetupProblem& problem) {
  bool const unknown = problem.message.starts_with("unknown ");
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (problem.where != where(study, values[k].node.place)) continue;
    if (unknown) problem.where = where(study, study.axes[k].place);
    if (study.mode == StudyMode::sobol && study.axes[k].range &&
        problem.message.find("whole number") != std::string::npos) {
      problem.message += "; \"sobol\" takes any numbers between a range's ends, so write the whole ones as a list";
    }
  }
}

void try_all(StudyFile const& study) {
  std::vector<SetupProblem> problems;
  for (std::vector<AxisValue> const& point : points_to_try(study)) {
    throw_if_interrupted();
    try {
      load_case_setup(compose(study, point, study.seed), FieldMemory::taken);
    } catch (SetupError const& error) {
      for (SetupProblem problem : error.problems()) {
        blame_the_axis(study, point, problem);
        auto const same = [&](SetupProblem const& known) {
          return known.where == problem.where && known.message == problem.message;
        };
        if (std::none_of(problems.begin(), problems.end(), same)) problems.push_back(problem);
      }
    }
  }
  if (!problems.empty()) throw SetupError(problems);
}

/// Results in RUN that are whole, without their numbers. @throws DataError where one is of another version
std::vector<CaseResult> whole_results(fs::path const& run) {
  std::vector<CaseResult> results;
  std::error_code error;
  for (fs::directory_iterator entry(run / run_file::cases, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() != ".json" || !entry->is_regular_file()) continue;
    std::string const path = entry->path().string();
    if (auto result = parse_result(read_text_file(path), path, ResultPart::head)) results.push_back(std::move(*result));
  }
  return results;
}

/// Whether a folder holds nothing but what write_plan() leaves when it is cut short: by a full disk, or killed.
bool left_by_a_cut_plan(fs::path const& folder) {
  std::error_code error;
  // study.toml is written after cases/ was made: alone it is somebody else's
  bool const ours = fs::is_directory(folder / run_file::cases, error) && fs::is_empty(folder / run_file::cases, error);
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    bool const partial =
        is_partial(name, stem_beside(run_file::manifest)) || is_partial(name, stem_beside(run_file::study));
    bool const written = name == run_file::cases || name == run_file::study || name == run_file::claims;
    if (!partial && !(ours && written) && name != "lost+found") return false;
  }
  return !error;
}

/// @throws OutputError where RUN is there and is no study's
void refuse_foreign_run(fs::path const& folder) {
  fs::path const manifest = folder / run_file::manifest;
  std::error_code error;
  if (fs::exists(manifest, error)) {
    std::string first;
    std::getline(std::ifstream(manifest), first);
    if (version_of_manifest(first)) return;
    throw OutputError(manifest.string(),
                      "is no gladstone manifest, and would be overwritten; choose another folder, or remove this file");
  }
  if (fs::exists(folder, error) && (!fs::is_directory(folder, error) || !left_by_a_cut_plan(folder))) {
    throw OutputError(folder.string(),
                      fmt::format("is there and holds no planned study (no {}); choose another folder or empty it",
                                  run_file::manifest));
  }
}

}  // namespace

std::vector<ManifestCase> plan_study(StudyFile const& study, std::string const& device) {
  try_all(study);
  std::vector<ManifestCase> cases;
  std::map<std::string, std::string> hashes;
  std::size_t const points = study.points();
  for (std::size_t repeat = 0; repeat < study.repeats; ++repeat) {
    for (std::size_t point = 0; point < points; ++point) {
      throw_if_interrupted();
      std::vector<AxisValue> const values = values_at(study, point);
      ManifestCase one;
      one.index = cases.size();
      one.repeat = repeat;
      one.seed = case_seed(study, repeat);
      one.device = device;
      for (std::size_t k = 0; k < values.size(); ++k) {
        one.parameters.emplace_back(study.axes[k].key, values[k].parameter);
      }
      SetupDocument document = compose(study, values, one.seed);
      read_setup(document.root());  // to learn which values are names of files
      read_correlation_settings(document.root().table("correlate"));
      one.setup = document.written();
      for (std::string const& name : document.file_names()) {
        std::string& hash = hashes[name];
        if (hash.empty()) hash = file_hash(name);
        one.inputs[name] = hash;
      }
      cases.push_back(std::move(one));
    }
  }
  return cases;
}

void try_plan_place(std::string const& run, StudyFile const& study) {
  fs::path const folder(run), manifest = folder / run_file::manifest;
  refuse_foreign_run(folder);
  refuse_inputs_as_outputs(
      {manifest.string(), (folder / run_file::study).string(), (folder / run_file::claims).string()},
      {study.path, study.base_path});
  OutputFile const tried(manifest.string());
}

Planned write_plan(std::string const& run, StudyFile const& study, std::vector<ManifestCase>& cases) {
  fs::path const folder(run), manifest = folder / run_file::manifest;
  std::string const text = manifest_text(cases);
  std::error_code error;
  Planned planned = Planned::fresh;
  if (fs::exists(manifest, error)) {
    refuse_foreign_run(folder);
    std::string const there = read_text_file(manifest.string());
    std::vector<CaseResult> const results = whole_results(folder);
    if (there == text) return Planned::unchanged;
    planned = Planned::replaced;
    auto const lost = [&cases](CaseResult const& result) {
      return result.index >= cases.size() || cases[result.index].line_hash != result.line_hash;
    };
    if (auto const count = std::count_if(results.begin(), results.end(), lost); count > 0) {
      int const version = *version_of_manifest(there);
      std::string const why = version == manifest_version
                                  ? "from another study"
                                  : fmt::format(
                                        "by another gladstone (its manifest is of version {}, this one writes "
                                        "version {})",
                                        version, manifest_version);
      throw OutputError(run,
                        fmt::format("was planned {}, and {} of its {} results would be lost; choose another folder, "
                                    "or remove this one",
                                    why, count, results.size()));
    }
    if (Claims(run, Claims::Use::look).any_held()) {
      throw OutputError(run,
                        "was planned from another study whose cases are being computed; choose another folder, or "
                        "stop them first");
    }
  } else {
    refuse_foreign_run(folder);
  }
  OutputFile plan(manifest.string());
  fs::create_directories(folder / run_file::cases, error);
  if (error) throw OutputError((folder / run_file::cases).string(), "cannot be made (" + error.message() + ')');
  OutputFile::write_text((folder / run_file::study).string(), study.text);
  Claims const made(run, Claims::Use::take);
  plan.write(text.data(), text.size());
  plan.commit();
  return planned;
}

}  // namespace gladstone
