#include "studies/sweep/study_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <unordered_map>

#include "render/base/error.h"
#include "render/base/sobol.h"
#include "render/files/text_file.h"
#include "render/setup/setup_table.h"
#include "studies/sweep/study_axis_reader.h"

namespace gladstone::inline sweep {
namespace {

/// Reads a study file and collects its problems with their positions.
class StudyReader {
 public:
  StudyReader(std::string const& path, std::string text)
      : document_(SetupDocument::from_text(text, path, folder_of(path))),
        source_(std::make_shared<SetupSource const>(SetupSource{path, folder_of(path)})) {
    study_.path = path;
    study_.text = std::move(text);
    if (document_.empty()) {
      throw SetupError({{path, "is empty (no key is set); gladstone sweep plan --help shows an example"}});
    }
  }

  StudyFile read() {
    SetupTable root = document_.root();
    if (!root.has("base") && (root.has("experiment") || root.has("camera"))) {
      throw SetupError({{study_.path,
                         "is a setup, not a study; write a study that names it as its key base: gladstone "
                         "init study -o study.toml"}});
    }
    study_.base_path = root.required_path("base");
    if (!study_.base_path.empty()) {
      try {
        study_.base = std::make_shared<SetupDocument const>(
            SetupDocument::from_text(read_text_file(study_.base_path, "a setup file", most_setup_bytes),
                                     study_.base_path, folder_of(study_.base_path)));
        if (study_.base->empty()) {
          throw DataError(ErrorCode::missing_content, study_.base_path, "is empty (no key is set)");
        }
      } catch (DataError const& error) {
        root.problem("base",
                     fmt::format("{} (the setup that every case starts from; relative names start at the "
                                 "study's folder)",
                                 error.what()),
                     error.code());
      }
    }
    read_settings(root.table("study"));  // first, since the mode determines which lists are allowed
    read_axes(root);
    check_sizes();
    document_.finish();
    return std::move(study_);
  }

 private:
  static std::string folder_of(std::string const& path) {
    return std::filesystem::absolute(path).parent_path().string();
  }
  /// Marks a location (line and column) as one in this study file, for values that are inserted into another document.
  SetupPlace placed(SetupPlace place) const {
    place.source = source_;
    return place;
  }
  void problem(SetupPlace const& place, std::string message) {
    document_.add_problem(fmt::format("{}:{}:{}", study_.path, std::max(place.line, 1), std::max(place.column, 1)),
                          std::move(message));
  }

  void read_axes(SetupTable& root) {
    if (!root.has("axes"))
      root.problem("axes", "is missing; write [axes] and below it \"key.path\" = [values]", ErrorCode::missing_key);
    root.mark_as_read("axes");
    SetupNode const* const axes = document_.find({"axes"});
    if (!axes) return;
    study_.place = placed(axes->place);
    if (axes->kind != SetupNode::Kind::table) {
      problem(axes->place, "axes must be a table; write [axes] and below it \"key.path\" = [values]");
      return;
    }
    if (axes->members.empty()) problem(axes->place, "[axes] is empty; name at least one key of the setup");
    if (axes->members.size() > most_axes) {
      problem(axes->place, fmt::format("[axes] has {} keys ({} at most); put those that do not change into the base",
                                       axes->members.size(), most_axes));
      return;
    }
    ReportProblem const report = [this](SetupPlace const& place, std::string message) {
      problem(place, std::move(message));
    };
    for (auto const& [key, node] : axes->members) {
      study_.axes.push_back(read_study_axis(key, node, source_, study_.mode, report));
    }
    std::stable_sort(study_.axes.begin(), study_.axes.end(), [](AxisPlan const& a, AxisPlan const& b) {
      return std::pair(a.place.line, a.place.column) < std::pair(b.place.line, b.place.column);
    });
  }

  void read_settings(SetupTable table) {
    std::string const mode = table.word("mode", "grid", {"grid", "zip", "sobol"});
    if (mode == "zip") study_.mode = StudyMode::zip;
    if (mode == "sobol") study_.mode = StudyMode::sobol;
    if (study_.mode == StudyMode::sobol) {
      study_.samples = static_cast<std::size_t>(table.required_integer("samples", 1, most));
    } else {
      table.refuse("samples",
                   "applies to mode = \"sobol\" only (the axes determine the number of cases of a grid or a zip)");
    }
    study_.repeats = static_cast<std::size_t>(table.integer("repeats", 1, 1, most));
    study_.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, most));
  }

  void check_sizes() {
    if (document_.has_problems() || study_.axes.empty()) return;
    refuse_axes_within_axes();
    SetupTable table = document_.root().table("study");
    if (study_.mode == StudyMode::sobol && study_.axes.size() > sobol_dimensions) {
      table.problem("mode", fmt::format("\"sobol\" takes up to {} axes (the study has {}); use fewer, or a grid",
                                        sobol_dimensions, study_.axes.size()));
    }
    if (study_.mode == StudyMode::zip) {
      AxisPlan const& first = study_.axes.front();
      for (AxisPlan const& axis : study_.axes) {
        if (axis.size() == first.size()) continue;
        problem(axis.place, fmt::format("\"{}\" has {} values but \"{}\" has {} (a zip combines the values of all axes "
                                        "one by one); give equally many, or use mode = \"grid\"",
                                        axis.key, axis.size(), first.key, first.size()));
      }
    }
    double cases = static_cast<double>(study_.repeats);
    if (study_.mode == StudyMode::sobol) cases *= static_cast<double>(study_.samples);
    if (study_.mode == StudyMode::zip) cases *= static_cast<double>(study_.axes.front().size());
    if (study_.mode == StudyMode::grid) {
      for (AxisPlan const& axis : study_.axes) cases *= static_cast<double>(axis.size());
    }
    if (cases > static_cast<double>(most_cases)) {
      problem(study_.place,
              fmt::format("the study has {} cases ({} at most); take fewer values or repeats, or mode = "
                          "\"sobol\" with samples",
                          cases < 1e15 ? fmt::format("{:.0f}", cases) : fmt::format("{:.3g}", cases), most_cases));
    } else if (study_.mode != StudyMode::sobol) {
      for (AxisPlan const& axis : study_.axes) refuse_steps_of_nothing(axis);
      if (study_.mode == StudyMode::zip && !document_.has_problems()) refuse_points_twice();
    }
  }

  /// Reports points of a zip at which all axes have the same values; they would count as repeats of one point.
  void refuse_points_twice() {
    std::unordered_map<std::string, std::size_t> points;
    for (std::size_t i = 0; i < study_.points(); ++i) {
      std::string labels;
      for (AxisPlan const& axis : study_.axes) labels += axis.value(i).parameter.label + '\0';
      auto const [known, fresh] = points.try_emplace(std::move(labels), i);
      if (fresh) continue;
      std::string named;
      for (AxisPlan const& axis : study_.axes) {
        named += fmt::format("{}{} = {}", named.empty() ? "" : ", ", axis.key, axis.value(i).parameter.label);
      }
      problem(study_.axes.front().value(i).node.place,
              fmt::format("the values {} and {} of the axes are the same ({}); remove one (repeats = N gives every "
                          "case N times, with other dots)",
                          known->second + 1, i + 1, named));
    }
  }

  /// Reports an axis for a key within a table that is itself an axis; the later one would overwrite the other.
  void refuse_axes_within_axes() {
    for (AxisPlan const& above : study_.axes) {
      for (AxisPlan const& axis : study_.axes) {
        if (axis.path.size() <= above.path.size()) continue;
        if (!std::equal(above.path.begin(), above.path.end(), axis.path.begin())) continue;
        problem(axis.place,
                fmt::format("\"{0}\" is part of \"{1}\", which is also an axis (line {2}), so that one would overwrite "
                            "the other; write its values into the tables of \"{1}\", or remove one of the two",
                            axis.key, above.key, above.place.line));
      }
    }
  }

  /// Reports a range that is so fine that two of its values are equal.
  void refuse_steps_of_nothing(AxisPlan const& axis) {
    if (!axis.range || surely_tells_values_apart(*axis.range)) return;
    for (std::size_t i = 1; i < axis.size(); ++i) {
      ParameterValue const value = axis.value(i).parameter;
      if (value.number != axis.value(i - 1).parameter.number) continue;
      problem(axis.place, fmt::format("\"{}\" has the value {} twice (numbers of a range have twelve digits); give a "
                                      "smaller count",
                                      axis.key, value.label));
      return;
    }
  }

  static constexpr long long most = std::numeric_limits<long long>::max();
  static constexpr std::size_t most_axes = 100;
  SetupDocument document_;
  std::shared_ptr<SetupSource const> source_;
  StudyFile study_;
};

}  // namespace

std::size_t StudyFile::points() const {
  if (mode == StudyMode::sobol) return samples;
  if (mode == StudyMode::zip) return axes.front().size();
  std::size_t count = 1;
  for (AxisPlan const& axis : axes) count *= axis.size();
  return count;
}

StudyFile read_study(std::string const& path) {
  std::string text;
  try {
    text = read_text_file(path, "a study file", most_setup_bytes);
  } catch (DataError const& error) {
    throw SetupError({{path, error.message(), "", error.code()}});
  }
  return StudyReader(path, std::move(text)).read();
}

}  // namespace gladstone::inline sweep
