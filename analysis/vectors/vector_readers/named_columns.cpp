#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/vectors/vector_readers/text_rows.h"
#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/text_file.h"

namespace gladstone::inline vectors {

DisplacementField plain_vectors(std::vector<double> const& x, std::vector<double> const& y,
                                std::vector<double> const& u, std::vector<double> const& v) {
  DisplacementField field;
  for (std::size_t i = 0; i < x.size(); ++i) {
    bool const measured = std::isfinite(u[i]) && std::isfinite(v[i]);
    field.position_px.push_back({x[i], y[i]});
    field.displacement_px.push_back({u[i], v[i]});
    field.status.push_back(measured ? VectorStatus::valid : VectorStatus::invalid);
  }
  return field;
}

void read_status(TextTable const& table, std::size_t column, DisplacementField& field) {
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const value = table.values[column][i];
    if (!(value == 0.0 || value == 1.0 || value == 2.0 || value == 3.0)) {
      throw DataError(ErrorCode::out_of_range, fmt::format("{}:{}", table.path, table.line[i]),
                      fmt::format("status = {} is not 0 (valid), 1 (replaced), 2 (masked) or 3 (invalid)", value));
    }
    field.status[i] = static_cast<VectorStatus>(static_cast<int>(value));
  }
}

bool read_validity(TextTable const& table, DisplacementField& field) {
  auto const choice = table.find({"chc"});
  auto const valid = table.find({"isvalid", "valid", "is valid"});
  for (std::size_t i = 0; i < field.size(); ++i) {
    VectorStatus& status = field.status[i];
    if (choice) {
      double const code = table.values[*choice][i];
      if (!(code >= 1.0)) status = VectorStatus::invalid;
      if (code > 1.0 && status == VectorStatus::valid) status = VectorStatus::replaced;
    } else if (valid && !(table.values[*valid][i] > 0.0)) {
      status = VectorStatus::masked;
    }
  }
  return choice || valid;
}

VectorFile read_quantities(TextTable const& table, std::string const& format,
                           std::initializer_list<std::string_view> others) {
  std::array<std::size_t, 4> const columns{table.quantity({"x"}), table.quantity({"y"}),
                                           table.quantity({"u", "vx", "dx"}), table.quantity({"v", "vy", "dy"})};
  std::array<std::string, 4> units;
  for (std::size_t i = 0; i < units.size(); ++i) {
    std::string unit = parse_column_name(table.names[columns[i]]).unit;
    units[i] = is_pixel_unit(unit) ? std::string() : std::move(unit);
  }
  auto const require_one_unit = [&](std::size_t a, std::size_t b) {
    if (units[a] == units[b]) return;
    throw DataError(ErrorCode::inconsistent, fmt::format("{}:{}", table.path, table.header_line),
                    fmt::format("columns {} and {} are in different units; export both in px", table.names[columns[a]],
                                table.names[columns[b]]));
  };
  require_one_unit(0, 1);
  require_one_unit(2, 3);
  VectorFile file{plain_vectors(table.values[columns[0]], table.values[columns[1]], table.values[columns[2]],
                                table.values[columns[3]]),
                  format,
                  {},
                  true};
  file.place_unit = units[0];
  file.displacement_unit = units[2];
  file.warnings = table.warnings;
  file.complete = table.complete;
  std::vector<std::string> unused;
  for (std::string const& name : table.names) {
    std::string const quantity = parse_column_name(name).quantity;
    auto const is_read = [&](std::size_t column) {
      return parse_column_name(table.names[column]).quantity == quantity;
    };
    bool const used = std::find(others.begin(), others.end(), lower_case(name)) != others.end() ||
                      std::any_of(columns.begin(), columns.end(), is_read);
    if (!used) unused.push_back(name);
  }
  if (!unused.empty())
    file.notes.push_back(fmt::format("{}:{}: columns not used: {}", table.path, table.header_line,
                                     excerpt(fmt::format("{}", fmt::join(unused, ", ")), 200)));
  return file;
}

void add_offsets(VectorFile& file, std::initializer_list<double> offsets_px) {
  std::vector<VectorConventions> readings = file.also;
  readings.insert(readings.begin(), file.conventions);
  for (VectorConventions reading : readings) {
    for (double const offset : offsets_px) {
      reading.offset_px = offset;
      file.also.push_back(reading);
    }
  }
}

// Accepts every table; read_named_columns() checks the columns.
bool has_named_columns(TextTable const&) { return true; }

VectorFile read_named_columns(TextTable const& table) {
  VectorFile file = read_quantities(table, "named columns",
                                    {"sigma_u_px", "sigma_u", "su", "sigma_v_px", "sigma_v", "sv", "peak_ratio",
                                     "status", "chc", "isvalid", "valid", "is valid"});
  DisplacementField& field = file.field;
  auto const sigma_u = table.find({"sigma_u_px", "sigma_u", "su"});
  auto const sigma_v = table.find({"sigma_v_px", "sigma_v", "sv"});
  if (sigma_u && sigma_v) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      field.sigma_px.push_back({table.values[*sigma_u][i], table.values[*sigma_v][i]});
    }
  }
  if (auto const ratio = table.find({"peak_ratio"})) field.peak_ratio = table.values[*ratio];
  if (auto const status = table.find({"status"})) {
    read_status(table, *status, field);
  } else {
    read_validity(table, field);
  }
  return file;
}

}  // namespace gladstone::inline vectors
