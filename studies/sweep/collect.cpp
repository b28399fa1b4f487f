#include "studies/sweep/collect.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "render/files/hdf5_file.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"
#include "render/files/text_file.h"
#include "studies/sweep/study_columns.h"
#include "studies/sweep/study_points.h"

namespace gladstone {
namespace {

/// Quotes a cell according to RFC 4180 if it contains a comma, quotation mark or line end.
std::string cell(std::string const& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string csv_of(StudyTable const& table, std::vector<StudyColumn> const& columns) {
  std::string text;
  for (StudyColumn const& column : columns) {
    if (!text.empty()) text += ',';
    text += cell(column.name);
  }
  for (StudyRow const& row : table.rows) {
    char separator = '\n';
    for (StudyColumn const& column : columns) {
      text += separator;
      separator = ',';
      double const number = column.number(row);
      if (column.name == "seed") {
        text += std::to_string(row.seed);  // more digits than a double has
      } else if (!column.labels.empty()) {
        text += cell(column.labels[static_cast<std::size_t>(number)]);
      } else {
        text += std::isnan(number) ? "nan" : fmt::format("{}", number);
      }
    }
  }
  return text + '\n';
}

}  // namespace

std::string study_csv(StudyTable const& table) { return csv_of(table, table_columns(table)); }

std::string points_csv(StudyTable const& points) { return csv_of(points, point_columns(points)); }

void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources) {
  FileOrigin const origin{"gladstone study", 2, setup, table.rows.front().seed, table.rows.front().device, sources};
  Hdf5Writer file(path, origin);
  write_columns(file, "/", "case", table, table_columns(table));
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
  if (!fs::exists(manifest, error)) read_manifest(run);  // throws DataError with an explanation
  refuse_inputs_as_outputs({in_run(run_file::table), in_run(run_file::table_text), points}, {study, manifest});
  ProtectedWritePermit const own;
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
