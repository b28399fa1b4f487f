#include "analysis/vectors/vector_readers/own_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/error.h"

namespace gladstone::inline vectors {
namespace {

constexpr std::array<std::string_view, 14> own_columns{
    "x_px",   "y_px",     "u_px",     "v_px",        "sigma_u_px", "sigma_v_px", "peak_ratio",
    "status", "u_raw_px", "v_raw_px", "correlation", "reason",     "ambiguous",  "failed_test"};

/// Checked access to the columns of a file that gladstone wrote.
class ColumnReader {
 public:
  explicit ColumnReader(OwnColumns const& columns) : columns_(columns), count_(required("x_px").size()) {
    for (auto const& [name, values] : columns.values) {
      if (values.size() == count_) continue;
      throw DataError(ErrorCode::wrong_shape, columns.path,
                      fmt::format("{}: {} values where x_px has {}", name, values.size(), count_));
    }
  }

  std::vector<double> const& required(std::string_view name) const {
    if (auto const* const values = find(name)) return *values;
    std::vector<std::string_view> names;
    for (auto const& column : columns_.values) names.push_back(column.first);
    throw DataError(ErrorCode::missing_content, columns_.path,
                    fmt::format("contains no column {}, which vectors of gladstone have (found: {}); give a file that "
                                "gladstone correlate or gladstone convert wrote",
                                name, names.empty() ? "other data only" : fmt::format("{}", fmt::join(names, ", "))));
  }

  /// Returns a column; null if the file lacks it.
  std::vector<double> const* find(std::string_view name) const {
    auto const found = columns_.values.find(name);
    return found == columns_.values.end() ? nullptr : &found->second;
  }

  /// Returns two columns as the components of vectors; empty if one of them is missing.
  std::vector<Vec2d> pairs(std::string_view x, std::string_view y) const {
    auto const *const first = find(x), *const second = find(y);
    std::vector<Vec2d> both;
    for (std::size_t i = 0; first && second && i < count_; ++i) both.push_back({(*first)[i], (*second)[i]});
    return both;
  }

  /// Returns a column of codes from 0 to `most`; empty if it is missing.
  template <class Code>
  std::vector<Code> codes(std::string_view name, Code most) const {
    std::vector<Code> found;
    auto const* const values = find(name);
    for (std::size_t i = 0; values && i < count_; ++i) {
      double const value = (*values)[i];
      if (!(value >= 0.0 && value <= static_cast<double>(most) && value == std::floor(value))) {
        bool const text = !columns_.line.empty();
        throw DataError(ErrorCode::out_of_range,
                        text ? fmt::format("{}:{}", columns_.path, columns_.line[i]) : columns_.path,
                        fmt::format("{}{} = {} is not a whole number from 0 to {}", name,
                                    text ? "" : fmt::format("[{}]", i), value, static_cast<int>(most)));
      }
      found.push_back(static_cast<Code>(static_cast<int>(value)));
    }
    return found;
  }

 private:
  OwnColumns const& columns_;
  std::size_t count_;
};

}  // namespace

bool is_own_column(std::string_view name) {
  return std::find(own_columns.begin(), own_columns.end(), name) != own_columns.end();
}

VectorFile read_own_columns(OwnColumns const& columns) {
  ColumnReader const reader(columns);
  DisplacementField field =
      plain_vectors(reader.required("x_px"), reader.required("y_px"), reader.required("u_px"), reader.required("v_px"));
  field.sigma_px = reader.pairs("sigma_u_px", "sigma_v_px");
  if (auto const* const ratio = reader.find("peak_ratio")) field.peak_ratio = *ratio;
  auto status = reader.codes("status", VectorStatus::invalid);
  if (!status.empty()) field.status = std::move(status);
  field.raw_px = reader.pairs("u_raw_px", "v_raw_px");
  if (auto const* const correlation = reader.find("correlation")) field.correlation = *correlation;
  field.reason = reader.codes("reason", VectorReason::outside);
  field.failed = reader.codes("failed_test", FailedTest::correlation);
  field.ambiguous = reader.codes("ambiguous", Ambiguity::here);
  return {std::move(field), "gladstone", {}, false};
}

}  // namespace gladstone::inline vectors
