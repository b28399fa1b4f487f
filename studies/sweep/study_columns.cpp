#include "studies/sweep/study_columns.h"

#include <map>
#include <nlohmann/json.hpp>

#include "studies/sweep/unit_ending.h"

namespace gladstone::inline sweep {
namespace {

std::string describe_measure(std::string const& measure) {
  static std::map<std::string, std::string> const known{
      {"signal_px", "rms of the ray truth at the vectors that count, per component"},
      {"error_over_signal", "rms error against Eq. 9 (PIV: the flow) over signal_px"},
      {"gradient_error_kg_m4",
       "rms error against Eq. 9 as a density gradient averaged over the thickness: eq9.rms_px over the sensitivity"},
      {"blur_px",
       "rms over these vectors of the standard deviation of a virtual dot's rays on the sensor in the measurement "
       "image, per component"},
      {"strain_max", "largest strain of the aperture-averaged Eq. 9 in the view"},
      {"magnification", "M = z_i / Z_B"},
      {"step_mm", "integration step of the rays"},
      {"rays_per_dot", "rays per dot"},
      {"exposure", "electrons in a fully lit pixel on the axis"},
      {"dots", "dots on the target"},
      {"caustic_fraction", "fraction of the view where the aperture-averaged strain is 1 or more"},
      {"saturated", "saturated pixels of both frames"},
      {"warnings", "number of warnings of the case; its result contains them"},
      {"repeats", "finished repeats of the point"},
      {"vectors", "vectors that count in all of them"},
      {"ray_truth.systematic_px", "measured minus ray truth: rms of the error common to all repeats, per component"},
      {"ray_truth.scatter_px", "measured minus ray truth: standard deviation between repeats, per component"},
      {"eq9.systematic_px", "measured minus Eq. 9: rms of the error common to all repeats, per component"},
      {"eq9.scatter_px", "measured minus Eq. 9: standard deviation between repeats, per component"},
      {"budget.estimator_px", "rms of the estimator's mean error over the patterns of the repeats, per component"},
      {"budget.pattern_px", "standard deviation of the estimator's error between patterns, per component"}};
  if (auto const found = known.find(measure); found != known.end()) return found->second;
  if (measure.ends_with(".mean")) return "mean over the repeats";
  return measure.ends_with(".std") ? "sample standard deviation over the repeats" : "as in errors.json";
}

void add_measures(StudyTable const& table, std::vector<StudyColumn>& columns) {
  for (std::size_t m = 0; m < table.measures.size(); ++m) {
    columns.push_back({table.measures[m],
                       [m](StudyRow const& row) { return row.measures[m]; },
                       {},
                       describe_measure(table.measures[m])});
  }
}

}  // namespace

std::string unit_of_column(std::string name) {
  for (char const* statistic : {".mean", ".std"}) {
    if (name.ends_with(statistic)) name.erase(name.rfind('.'));
  }
  if (name.starts_with("seconds_")) return "s";
  if (name == "exposure") return "e";
  return std::string(unit_ending(name).value_or(UnitEnding{"", "1"}).unit);
}

std::vector<StudyColumn> axis_columns(StudyTable const& table) {
  std::vector<StudyColumn> columns;
  for (std::size_t k = 0; k < table.axes.size(); ++k) {
    StudyAxis const& axis = table.axes[k];
    columns.push_back({axis.key,
                       [&axis, k](StudyRow const& row) {
                         return axis.numeric ? axis.numbers[row.value[k]] : static_cast<double>(row.value[k]);
                       },
                       axis.numeric ? std::vector<std::string>{} : axis.labels, "axis: a key of the setup",
                       !axis.numeric});
    if (!axis.labelled) continue;
    columns.push_back({axis.key + ".label", [k](StudyRow const& row) { return static_cast<double>(row.value[k]); },
                       axis.labels, "label of the value of the axis", true});
  }
  columns.push_back({"case",
                     [](StudyRow const& row) { return static_cast<double>(row.index); },
                     {},
                     "line of the manifest, from 0; for a point the first one",
                     true});
  return columns;
}

std::vector<StudyColumn> table_columns(StudyTable const& table) {
  std::vector<StudyColumn> columns = axis_columns(table);
  columns.push_back({"seed",
                     [](StudyRow const& row) { return static_cast<double>(row.seed); },
                     {},
                     "seed of target, rays and noise",
                     true});
  columns.push_back({"status",
                     [](StudyRow const& row) { return static_cast<double>(row.status); },
                     {"ok", "failed", "missing"},
                     "status of the case",
                     true});
  columns.push_back(
      {"repeat", [](StudyRow const& row) { return static_cast<double>(row.repeat); }, {}, "from 0", true});
  add_measures(table, columns);
  columns.push_back({"seconds_compare",
                     [](StudyRow const& row) { return row.seconds_compare; },
                     {},
                     "time of the comparison with truth and theory"});
  columns.push_back({"seconds_render",
                     [](StudyRow const& row) { return row.seconds_render; },
                     {},
                     "time of building, planning and rendering; little if another case had done it"});
  columns.push_back(
      {"seconds_correlate", [](StudyRow const& row) { return row.seconds_correlate; }, {}, "time of the correlation"});
  columns.push_back({"device",
                     [](StudyRow const& row) { return row.on_gpu ? 1.0 : 0.0; },
                     {"cpu", "cuda"},
                     "device that computed the case",
                     true});
  return columns;
}

std::vector<StudyColumn> point_columns(StudyTable const& points) {
  std::vector<StudyColumn> columns = axis_columns(points);
  add_measures(points, columns);
  return columns;
}

void write_columns(Hdf5Writer& file, Hdf5Axes& axes, std::string const& group, std::string const& row_name,
                   StudyTable const& table, std::vector<StudyColumn> const& columns) {
  std::vector<std::size_t> const shape{table.rows.size()};
  for (StudyColumn const& column : columns) {
    std::string const name = group + column.name;
    if (column.whole) {
      std::vector<std::int64_t> numbers;
      for (StudyRow const& row : table.rows) {
        numbers.push_back(column.name == "seed" ? static_cast<std::int64_t>(row.seed)
                                                : static_cast<std::int64_t>(column.number(row)));
      }
      file.write(name, numbers, shape, "1", column.description, row_name);
    } else {
      std::vector<double> numbers;
      for (StudyRow const& row : table.rows) numbers.push_back(column.number(row));
      file.write(name, numbers, shape, unit_of_column(column.name), column.description, row_name);
    }
    if (column.name != "case") axes.name(name, {group + "case"});
    if (!column.labels.empty()) file.attribute(name, "labels", nlohmann::json(column.labels).dump());
  }
}

}  // namespace gladstone::inline sweep
