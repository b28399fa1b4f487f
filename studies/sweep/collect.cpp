#include "studies/sweep/collect.h"

#include <fmt/format.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "render/base/error.h"
#include "render/files/hdf5_axes.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"
#include "render/files/text_file.h"
#include "studies/sweep/study_points.h"

namespace gladstone::inline sweep {
namespace {

/// Number of cases from which the table is written directly to the disk. Smaller ones, of some megabytes, are prepared
/// in memory, which does not require free space on the disk beyond their size (Hdf5Growth).
constexpr std::size_t large_study = 4096;

/// Quotes a cell according to RFC 4180 if it contains a comma, quotation mark or line end.
std::string cell(std::string const& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (char const c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// Appends a row of a CSV, without line end.
void append_row(std::string& text, StudyRow const& row, std::vector<StudyColumn> const& columns) {
  for (StudyColumn const& column : columns) {
    if (&column != &columns.front()) text += ',';
    double const number = column.number(row);
    if (column.name == "seed") {
      text += std::to_string(row.seed);  // more digits than a double has
    } else if (!column.labels.empty()) {
      text += cell(column.labels[static_cast<std::size_t>(number)]);
    } else if (std::isnan(number)) {
      text += "nan";
    } else {
      fmt::format_to(std::back_inserter(text), "{}", number);
    }
  }
}

void write_csv_file(std::string const& path, StudyTable const& table, std::vector<StudyColumn> const& columns) {
  OutputFile output(path);
  errno = 0;
  std::ofstream file(output.temporary_path(), std::ios::binary);
  write_csv(file, table, columns);
  file.close();
  if (!file) {
    throw OutputError(path, fmt::format("cannot be written ({})", std::strerror(errno != 0 ? errno : EIO)));
  }
  output.commit();
}

}  // namespace

void write_csv(std::ostream& out, StudyTable const& table, std::vector<StudyColumn> const& columns) {
  std::string text;
  for (StudyColumn const& column : columns) {
    if (!text.empty()) text += ',';
    text += cell(column.name);
  }
  out << text << '\n';
  for (StudyRow const& row : table.rows) {
    text.clear();
    append_row(text, row, columns);
    out << text << '\n';
  }
}

void write_study_h5(std::string const& path, StudyTable const& table, std::string const& setup,
                    SourceFiles const& sources) {
  FileOrigin const origin{"gladstone study", 2, setup, table.rows.front().seed, table.rows.front().device(), sources};
  Hdf5Writer file(path, origin, table.rows.size() < large_study ? Hdf5Growth::in_memory : Hdf5Growth::on_disk);
  Hdf5Axes axes(file);
  write_columns(file, axes, "/", "case", table, table_columns(table));
  if (table.repeats() > 1) {
    StudyTable const points = study_points(table);
    write_columns(file, axes, "/points/", "point", points, point_columns(points));
  }
  axes.attach();
  nlohmann::json keys = nlohmann::json::array();
  for (StudyAxis const& axis : table.axes) keys.push_back(axis.key);
  file.attribute("/", "study_axes", keys.dump());
  file.attribute("/", "computed_by", nlohmann::json(table.builds).dump());
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
  write_csv_file(in_run(run_file::table_text), table, table_columns(table));
  if (table.repeats() > 1) {
    StudyTable const of_points = study_points(table);
    write_csv_file(points, of_points, point_columns(of_points));
  } else {
    fs::remove(points, error);
  }
  return table;
}

}  // namespace gladstone::inline sweep
