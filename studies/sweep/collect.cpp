#include "studies/sweep/collect.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "render/base/hdf5_file.h"
#include "render/base/output_file.h"
#include "render/base/text_file.h"
#include "studies/sweep/study_points.h"
#include "studies/sweep/unit_ending.h"

namespace gladstone {
namespace {

/// One column of numbers, and what its whole numbers stand for.
struct Column {
  std::string name;
  std::function<double(StudyRow const&)> number;
  std::vector<std::string> labels;  ///< the number is a place in this list; empty: it is itself
  std::string description;
  bool whole = false;
};

/// RFC 4180: quotes where a comma, a quote or a line end stands inside.
std::string cell(std::string const& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// @param name of a column; a statistic of a measure has the measure's unit
std::string unit_of(std::string name) {
  for (char const* statistic : {".mean", ".std"}) {
    if (name.ends_with(statistic)) name.erase(name.rfind('.'));
  }
  if (name.starts_with("seconds_")) return "s";
  if (name == "exposure") return "e";
  return std::string(unit_ending(name).value_or(UnitEnding{"", "1"}).unit);
}

std::string description_of(std::string const& measure) {
  static std::map<std::string, std::string> const known{
      {"signal_px", "rms of the ray truth at the vectors that count, per component"},
      {"blur_px",
       "rms over those vectors of the standard deviation of a virtual dot's hits in the flow, per component"},
      {"strain_max", "largest strain of the cone-averaged Eq. 9 in the view"},
      {"magnification", "M = z_i / Z_B"},
      {"step_mm", "step that rays were traced with"},
      {"rays_per_dot", "rays of a dot"},
      {"exposure", "electrons in a fully lit pixel on the axis"},
      {"dots", "dots on the target"},
      {"caustic_fraction", "share of the view where the cone-averaged strain is 1 or more"},
      {"saturated", "saturated pixels of both frames"},
      {"warnings", "warnings that the case gave; they stand in its result"},
      {"repeats", "finished repeats of the point"},
      {"vectors", "vectors that count in all of them"},
      {"ray_truth.systematic_px", "measured less ray truth: rms of what is the same in every repeat, per component"},
      {"ray_truth.scatter_px", "measured less ray truth: standard deviation between repeats, per component"},
      {"eq9.systematic_px", "measured less Eq. 9: rms of what is the same in every repeat, per component"},
      {"eq9.scatter_px", "measured less Eq. 9: standard deviation between repeats, per component"},
      {"budget.estimator_px", "rms of the estimator's mean error over the patterns of the repeats, per component"},
      {"budget.pattern_px", "standard deviation of the estimator's error between patterns, per component"}};
  if (auto const found = known.find(measure); found != known.end()) return found->second;
  if (measure.ends_with(".mean")) return "mean over the repeats";
  return measure.ends_with(".std") ? "sample standard deviation over the repeats" : "as in errors.json";
}

/// Columns that tell a table's rows apart.
std::vector<Column> axis_columns(StudyTable const& table) {
  std::vector<Column> columns;
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
                       axis.labels, "what the study calls the value of that key", true});
  }
  columns.push_back({"case",
                     [](StudyRow const& row) { return static_cast<double>(row.index); },
                     {},
                     "line of the manifest, from 0; of a point, the first",
                     true});
  return columns;
}

void add_measures(StudyTable const& table, std::vector<Column>& columns) {
  for (std::size_t m = 0; m < table.measures.size(); ++m) {
    columns.push_back({table.measures[m],
                       [m](StudyRow const& row) { return row.measures[m]; },
                       {},
                       description_of(table.measures[m])});
  }
}

std::vector<Column> columns_of(StudyTable const& table) {
  std::vector<Column> columns = axis_columns(table);
  columns.push_back({"seed",
                     [](StudyRow const& row) { return static_cast<double>(row.seed); },
                     {},
                     "of target, rays and noise",
                     true});
  columns.push_back({"status",
                     [](StudyRow const& row) { return static_cast<double>(row.status); },
                     {"ok", "failed", "missing"},
                     "what became of the case",
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
                     "time of building, planning and rendering; little where another case had done it"});
  columns.push_back(
      {"seconds_correlate", [](StudyRow const& row) { return row.seconds_correlate; }, {}, "time of the correlation"});
  columns.push_back({"device",
                     [](StudyRow const& row) { return row.device == "cuda" ? 1.0 : 0.0; },
                     {"cpu", "cuda"},
                     "what computes the case",
                     true});
  return columns;
}

std::vector<Column> point_columns(StudyTable const& points) {
  std::vector<Column> columns = axis_columns(points);
  add_measures(points, columns);
  return columns;
}

std::string csv_of(StudyTable const& table, std::vector<Column> const& columns) {
  std::string text;
  for (Column const& column : columns) {
    if (!text.empty()) text += ',';
    text += cell(column.name);
  }
  for (StudyRow const& row : table.rows) {
    char separator = '\n';
    for (Column const& column : columns) {
      text += separator;
      separator = ',';
      double const number = column.number(row);
      if (column.name == "seed") {
        text += std::to_string(row.seed);  // has more digits than a double
      } else if (!column.labels.empty()) {
        text += cell(column.labels[static_cast<std::size_t>(number)]);
      } else {
        text += std::isnan(number) ? "nan" : fmt::format("{}", number);
      }
    }
  }
  return text + '\n';
}

/// @param group "/" or "/points/" @param row_name what a row is
void write_columns(Hdf5Writer& file, std::string const& group, std::string const& row_name, StudyTable const& table,
                   std::vector<Column> const& columns) {
  std::vector<std::size_t> const shape{table.rows.size()};
  for (Column const& column : columns) {
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
      file.write(name, numbers, shape, unit_of(column.name), column.description, row_name);
    }
    if (!column.labels.empty()) file.attribute(name, "labels", nlohmann::json(column.labels).dump());
  }
}

}  // namespace

std::string study_csv(StudyTable const& table) { return csv_of(table, columns_of(table)); }

std::string points_csv(StudyTable const& points) { return csv_of(points, point_columns(points)); }

void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources) {
  FileOrigin const origin{"gladstone study", 2, setup, table.rows.front().seed, table.rows.front().device, sources};
  Hdf5Writer file(path, origin);
  write_columns(file, "/", "case", table, columns_of(table));
  if (table.repeats() > 1) {
    StudyTable const points = study_points(table);
    write_columns(file, "/points/", "point", points, point_columns(points));
  }
  nlohmann::json keys = nlohmann::json::array();
  for (StudyAxis const& axis : table.axes) keys.push_back(axis.key);
  file.attribute("/", "study_axes", keys.dump());
  file.attribute("/", "computed_by", nlohmann::json(table.builds()).dump());
  file.close();
}

StudyTable collect_study(std::string const& run) {
  namespace fs = std::filesystem;
  auto const in_run = [&run](char const* name) { return (fs::path(run) / name).string(); };
  std::string const study = in_run(run_file::study), manifest = in_run(run_file::manifest);
  std::string const points = in_run(run_file::points_text);
  std::error_code error;
  if (!fs::exists(manifest, error)) read_manifest(run);  // says so
  refuse_inputs_as_outputs({in_run(run_file::table), in_run(run_file::table_text), points}, {study, manifest});
  OutputFile const tried(in_run(run_file::table));
  SourceFiles sources;
  sources.add("manifest", manifest, SourceFiles::Holds::bytes);
  StudyTable table = read_study_table(run);
  write_study_h5(in_run(run_file::table), table, fs::exists(study, error) ? read_text_file(study) : "", sources);
  OutputFile::write_text(in_run(run_file::table_text), study_csv(table));
  if (table.repeats() > 1) {
    OutputFile::write_text(points, points_csv(study_points(table)));
  } else {
    fs::remove(points, error);
  }
  return table;
}

}  // namespace gladstone
