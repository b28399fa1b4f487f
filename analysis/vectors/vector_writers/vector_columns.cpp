#include "analysis/vectors/vector_writers/vector_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline vectors {
namespace {

template <class Value>
VectorColumn make_column(std::string name, std::string units, std::string description, std::size_t count,
                         Value const& value_of) {
  VectorColumn column{std::move(name), std::move(units), std::move(description), false, std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) column.values[i] = value_of(i);
  return column;
}

/// Returns a column of codes; vectors without codes have code 0.
template <class Code>
VectorColumn make_codes(std::string name, std::string description, std::size_t count, std::vector<Code> const& codes) {
  VectorColumn column = make_column(std::move(name), "1", std::move(description), count, [&](std::size_t i) {
    return codes.empty() ? 0.0 : static_cast<double>(static_cast<int>(codes[i]));
  });
  column.is_code = true;
  return column;
}

}  // namespace

bool VectorColumn::is_known() const {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

std::vector<VectorColumn> vector_columns(DisplacementField const& field) {
  std::size_t const count = field.size();
  auto const& place = field.position_px;
  auto const& shift = field.displacement_px;
  auto const& raw = field.raw_px.empty() ? shift : field.raw_px;
  auto const& sigma = field.sigma_px;
  auto const number = [count](char const* name, char const* units, char const* description, auto const& value_of) {
    return make_column(name, units, description, count, value_of);
  };
  std::vector<Ambiguity> ambiguous = field.ambiguous;  // files do not state in which pass a vector became ambiguous
  std::replace(ambiguous.begin(), ambiguous.end(), Ambiguity::earlier, Ambiguity::here);
  return {
      number("x_px", "px", "column of the window centre, pixel centres at integers from 0",
             [&](std::size_t i) { return place[i].x; }),
      number("y_px", "px", "row of the window centre, downwards", [&](std::size_t i) { return place[i].y; }),
      number("u_px", "px", "displacement to the right, flow minus reference",
             [&](std::size_t i) { return shift[i].x; }),
      number("v_px", "px", "displacement downwards, flow minus reference", [&](std::size_t i) { return shift[i].y; }),
      number("sigma_u_px", "px", "estimated standard uncertainty of u",
             [&](std::size_t i) { return sigma.empty() ? not_a_number : sigma[i].x; }),
      number("sigma_v_px", "px", "estimated standard uncertainty of v",
             [&](std::size_t i) { return sigma.empty() ? not_a_number : sigma[i].y; }),
      number("peak_ratio", "1", "height of the highest correlation peak over that of the second highest",
             [&](std::size_t i) { return field.peak_ratio.empty() ? not_a_number : field.peak_ratio[i]; }),
      status_column(field.status, count),
      number("u_raw_px", "px", "displacement to the right before replacement", [&](std::size_t i) { return raw[i].x; }),
      number("v_raw_px", "px", "displacement downwards before replacement", [&](std::size_t i) { return raw[i].y; }),
      number("correlation", "1", "correlation coefficient of the peak at u_raw_px, v_raw_px",
             [&](std::size_t i) { return field.correlation.empty() ? not_a_number : field.correlation[i]; }),
      make_codes("reason",
                 "0 measured, 1 replaced by another peak, 2 replaced by the median of the neighbours, 3 masked, 4 no "
                 "signal, 5 spurious and not replaced, 6 no peak in range, 7 uncorrelated, 8 moved out of the frames",
                 count, field.reason),
      make_codes("ambiguous", "1 if another displacement has (nearly) the same correlation", count, ambiguous),
  };
}

VectorTable vector_table(DisplacementField const& field) {
  return {vector_columns(field), field.columns, field.rows, "px, y and v downwards"};
}

VectorColumn number_column(std::string name, std::string units, std::string description, std::vector<double> values) {
  return {std::move(name), std::move(units), std::move(description), false, std::move(values)};
}

VectorColumn status_column(std::vector<VectorStatus> const& status, std::size_t count) {
  return make_codes("status", "0 valid, 1 replaced, 2 masked, 3 invalid", count, status);
}

VectorColumn failed_test_column(DisplacementField const& field) {
  return make_codes("failed_test", "0 none, 1 median, 2 whole displacement, 3 peak ratio, 4 correlation", field.size(),
                    field.failed);
}

VectorGrid require_vector_grid(DisplacementField const& field, std::string const& path, std::string const& kind) {
  if (field.columns <= 0 || field.rows <= 0) {
    throw OutputError(path, fmt::format("requires vectors on a grid ({} stores them in rows and columns, and these {} "
                                        "vectors are scattered); write .vtp, .mat, .dat, .csv or .h5",
                                        kind, field.size()));
  }
  VectorGrid grid;
  auto const columns = static_cast<std::size_t>(field.columns);
  for (std::size_t i = 0; i < columns; ++i) grid.x.push_back(field.position_px[i].x);
  for (std::size_t i = 0; i < field.size(); i += columns) grid.y.push_back(field.position_px[i].y);
  return grid;
}

VectorColumn const& column_named(std::vector<VectorColumn> const& columns, std::string const& name) {
  auto const found =
      std::find_if(columns.begin(), columns.end(), [&](VectorColumn const& one) { return one.name == name; });
  GLADSTONE_EXPECTS(found != columns.end());
  return *found;
}

}  // namespace gladstone::inline vectors
