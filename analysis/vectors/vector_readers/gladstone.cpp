#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "analysis/vectors/vector_readers/own_columns.h"
#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/text.h"

namespace gladstone::inline vectors {
namespace {

/// Columns that vectors.h5 and vectors.csv contain in every version of gladstone.
constexpr std::array<char const*, 8> oldest_columns{"x_px",       "y_px",       "u_px",       "v_px",
                                                    "sigma_u_px", "sigma_v_px", "peak_ratio", "status"};

void require_oldest_datasets(Hdf5Reader const& file, std::string const& path) {
  for (std::string const name : oldest_columns) {
    if (file.has('/' + name)) continue;
    std::string const type = file.attribute("filetype");
    if (!type.empty() && type != "gladstone vectors") {
      throw DataError(ErrorCode::wrong_format, path,
                      fmt::format("is a file of \"{}\", which contains no vectors of an image pair; use "
                                  "vectors.h5 of gladstone correlate",
                                  type));
    }
    throw DataError(ErrorCode::missing_content, path,
                    fmt::format("no dataset /{} (the file contains {}); use vectors.h5 of gladstone correlate", name,
                                fmt::join(file.dataset_names(), ", ")));
  }
}

/// Converts a text table to columns of gladstone.
OwnColumns columns_of(TextTable const& table) {
  OwnColumns columns{table.path, {}, table.line};
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    std::string const name = lower_case(table.names[i]);
    if (is_own_column(name)) columns.values.try_emplace(name, table.values[i]);
  }
  return columns;
}

/// Restores the unknown values of Tecplot files of older versions, which contain 0 instead and do not mark these
/// values.
void restore_unmarked(DisplacementField& field) {
  auto const known = [](double value) { return value > 0.0 ? value : not_a_number; };
  for (Vec2d& sigma : field.sigma_px) sigma = {known(sigma.x), known(sigma.y)};
  for (double& ratio : field.peak_ratio) ratio = known(ratio);
  for (double& correlation : field.correlation) correlation = correlation != 0.0 ? correlation : not_a_number;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.counts(i)) continue;
    field.displacement_px[i] = {not_a_number, not_a_number};
    if (!field.raw_px.empty() && field.raw_px[i] == Vec2d{}) field.raw_px[i] = {not_a_number, not_a_number};
  }
}

/// Replaces the values that the column `unknown` marks by NaN; bit k of a mark belongs to column k.
/// @throws DataError with file:line if a mark is not a sum of such bits
void restore_marked(OwnColumns& columns, TextTable const& table, std::vector<double> const& marks) {
  constexpr std::size_t exact_bits = 53;
  std::size_t const bits = std::min(table.names.size(), exact_bits);
  double const limit = std::ldexp(1.0, static_cast<int>(bits));
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!(marks[i] >= 0.0 && marks[i] < limit && marks[i] == std::floor(marks[i]))) {
      throw DataError(ErrorCode::out_of_range, fmt::format("{}:{}", table.path, table.line[i]),
                      fmt::format("unknown = {} is not a sum of powers of 2, one for each column; convert the vectors "
                                  "again",
                                  marks[i]));
    }
    auto const mark = static_cast<std::uint64_t>(marks[i]);
    for (std::size_t k = 0; k < bits; ++k) {
      if ((mark >> k & 1u) == 0) continue;
      auto const column = columns.values.find(lower_case(table.names[k]));
      if (column != columns.values.end()) column->second[i] = not_a_number;
    }
  }
}

/// Reads the verdict on the pair; files of older versions have its text but no code.
PairVerdict read_verdict(Hdf5Reader const& file) {
  std::string const code = file.attribute("verdict_code");
  if (code.empty()) return find_verdict(file.attribute("verdict"));
  return {find_verdict_kind(code), std::strtod(file.attribute("verdict_number").c_str(), nullptr)};
}

}  // namespace

VectorFile read_gladstone_hdf5(std::string const& path) {
  Hdf5Reader const file(path);
  require_oldest_datasets(file, path);
  OwnColumns columns{path};
  for (std::string const& name : file.dataset_names()) {
    if (is_own_column(name)) columns.values[name] = file.read('/' + name);
  }
  VectorFile vectors = read_own_columns(columns);
  vectors.field.verdict = read_verdict(file);
  vectors.field.uncertainty_method = file.attribute("uncertainty_method");
  vectors.field.uncertainty_key = file.attribute("uncertainty_key");
  return vectors;
}

bool is_gladstone_csv(TextTable const& table) {
  return std::all_of(oldest_columns.begin(), oldest_columns.end(),
                     [&](char const* name) { return table.find({name}).has_value(); });
}

VectorFile read_gladstone_csv(TextTable const& table) { return read_own_columns(columns_of(table)); }

bool is_gladstone_tecplot(TextTable const& table) {
  return table.tecplot && table.find({"x_px"}) && table.find({"y_px"}) && table.find({"u_px"}) &&
         table.find({"v_px"}) && table.find({"status"});
}

VectorFile read_gladstone_tecplot(TextTable const& table) {
  OwnColumns columns = columns_of(table);
  auto const marks = table.find({"unknown"});
  if (marks) restore_marked(columns, table, table.values[*marks]);
  VectorFile file = read_own_columns(columns);
  if (!marks) restore_unmarked(file.field);
  file.warnings = table.warnings;
  file.complete = table.complete;
  return file;
}

}  // namespace gladstone::inline vectors
