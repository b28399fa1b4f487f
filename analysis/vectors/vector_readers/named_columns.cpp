#include <fmt/format.h>

#include <cmath>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"

namespace gladstone::detail {

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
      throw DataError(fmt::format("{}:{}", table.path, table.line[i]),
                      fmt::format("status = {} is not 0 (valid), 1 (replaced), 2 (masked) or 3 (invalid)", value));
    }
    field.status[i] = static_cast<VectorStatus>(static_cast<int>(value));
  }
}

bool has_named_columns(TextTable const&) { return true; }  // the last row of the table: its columns are checked here

VectorFile read_named_columns(TextTable const& table) {
  DisplacementField field = plain_vectors(table.column({"x", "x_px"}), table.column({"y", "y_px"}),
                                          table.column({"u", "u_px"}), table.column({"v", "v_px"}));
  auto const sigma_u = table.find({"sigma_u_px", "sigma_u", "su"});
  auto const sigma_v = table.find({"sigma_v_px", "sigma_v", "sv"});
  if (sigma_u && sigma_v) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      field.sigma_px.push_back({table.values[*sigma_u][i], table.values[*sigma_v][i]});
    }
  }
  if (auto const ratio = table.find({"peak_ratio"})) field.peak_ratio = table.values[*ratio];
  if (auto const status = table.find({"status"})) read_status(table, *status, field);
  return {std::move(field), "named columns", {}, true};
}

}  // namespace gladstone::detail
