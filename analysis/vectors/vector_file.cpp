#include "analysis/vectors/vector_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/base/not_a_number.h"
#include "render/files/output_file.h"

namespace gladstone {
namespace {

/// Reader of a text format. Readers are tried in order; the last accepts every table. A new format requires one more
/// row.
struct TextReader {
  bool (*recognizes)(detail::TextTable const&);
  VectorFile (*read)(detail::TextTable const&);
};
constexpr std::array<TextReader, 7> text_readers{{
    {detail::is_gladstone_csv, detail::read_gladstone_csv},
    {detail::is_pivlab, detail::read_pivlab},
    {detail::is_tecplot, detail::read_tecplot},
    {detail::is_dantec, detail::read_dantec},
    {detail::is_jpiv, detail::read_jpiv},
    {detail::is_openpiv, detail::read_openpiv},
    {detail::has_named_columns, detail::read_named_columns},
}};

VectorFile read_text(std::string const& path) {
  detail::TextTable const table = detail::read_text_table(path);
  auto const* const reader =
      std::find_if(text_readers.begin(), text_readers.end(), [&](TextReader const& r) { return r.recognizes(table); });
  return reader->read(table);
}

/// Returns the distinct values of a coordinate in ascending order; values within 0.01 px are equal.
std::vector<double> distinct(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  std::vector<double> levels;
  for (double const value : values) {
    if (levels.empty() || value - levels.back() > 0.01) levels.push_back(value);
  }
  return levels;
}

std::size_t level_of(std::vector<double> const& levels, double value) {
  auto const above = std::upper_bound(levels.begin(), levels.end(), value);
  return static_cast<std::size_t>(above - levels.begin()) - 1;
}

template <class T>
void reorder(std::vector<T>& values, std::vector<std::size_t> const& order) {
  if (values.empty()) return;
  std::vector<T> sorted;
  sorted.reserve(values.size());
  for (std::size_t const i : order) sorted.push_back(values[i]);
  values = std::move(sorted);
}

}  // namespace

void take_vectors(DisplacementField& field, std::vector<std::size_t> const& order) {
  reorder(field.position_px, order);
  reorder(field.displacement_px, order);
  reorder(field.sigma_px, order);
  reorder(field.peak_ratio, order);
  reorder(field.status, order);
  reorder(field.raw_px, order);
  reorder(field.correlation, order);
  reorder(field.reason, order);
  reorder(field.failed, order);
  reorder(field.ambiguous, order);
  field.columns = field.rows = 0;
}

void arrange_as_grid(DisplacementField& field) {
  field.columns = field.rows = 0;
  std::vector<double> x, y;
  for (Vec2d const& p : field.position_px) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return;
    x.push_back(p.x);
    y.push_back(p.y);
  }
  std::vector<double> const columns = distinct(x);
  std::vector<double> const rows = distinct(y);
  if (columns.empty() || columns.size() * rows.size() != field.size()) return;

  // If every vector occupies its own node, `order` becomes a permutation.
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> order(field.size(), none);
  for (std::size_t i = 0; i < field.size(); ++i) {
    std::size_t& node = order[level_of(rows, y[i]) * columns.size() + level_of(columns, x[i])];
    if (node != none) return;
    node = i;
  }
  take_vectors(field, order);
  field.columns = static_cast<int>(columns.size());
  field.rows = static_cast<int>(rows.size());
}

VectorFile read_vectors(std::string const& path) {
  bool const hdf5 = path.ends_with(".h5") || path.ends_with(".hdf5");
  VectorFile file = hdf5 ? detail::read_gladstone_hdf5(path) : read_text(path);
  arrange_as_grid(file.field);
  return file;
}

void write_vectors(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  std::size_t const count = field.size();
  auto const sigma = [&](std::size_t i) {
    return field.sigma_px.empty() ? Vec2d{not_a_number, not_a_number} : field.sigma_px[i];
  };
  auto const ratio = [&](std::size_t i) { return field.peak_ratio.empty() ? not_a_number : field.peak_ratio[i]; };
  auto const status = [&](std::size_t i) { return field.status.empty() ? 0 : static_cast<int>(field.status[i]); };
  // Vectors without raw displacements are their own raw displacements, with reason 0 (as measured).
  auto const raw = [&](std::size_t i) { return field.raw_px.empty() ? field.displacement_px[i] : field.raw_px[i]; };
  auto const correlation = [&](std::size_t i) {
    return field.correlation.empty() ? not_a_number : field.correlation[i];
  };
  auto const reason = [&](std::size_t i) { return field.reason.empty() ? 0 : static_cast<int>(field.reason[i]); };
  auto const failed = [&](std::size_t i) { return field.failed.empty() ? 0 : static_cast<int>(field.failed[i]); };
  auto const ambiguous = [&](std::size_t i) {
    return !field.ambiguous.empty() && field.ambiguous[i] != Ambiguity::none ? 1 : 0;
  };

  if (path.ends_with(".csv")) {
    std::string text =
        "x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status,u_raw_px,v_raw_px,correlation,reason,ambiguous\n";
    for (std::size_t i = 0; i < count; ++i) {
      Vec2d const p = field.position_px[i], d = field.displacement_px[i], s = sigma(i), r = raw(i);
      fmt::format_to(std::back_inserter(text),
                     "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{},{:.17g},{:.17g},{:.17g},{},{}\n", p.x,
                     p.y, d.x, d.y, s.x, s.y, ratio(i), status(i), r.x, r.y, correlation(i), reason(i), ambiguous(i));
    }
    OutputFile file(path);
    file.write(text.data(), text.size());
    origin.sources.check();
    file.commit();
    return;
  }
  if (!path.ends_with(".h5")) {
    throw std::invalid_argument(path + ": vectors are written as .h5 or .csv; use one of these endings");
  }

  Hdf5Writer file(path, origin);
  auto const write = [&](char const* name, char const* units, char const* description, auto const& value_of) {
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = value_of(i);
    file.write(name, std::span<double const>(values), {count}, units, description, "vector");
  };
  auto const& p = field.position_px;
  auto const& d = field.displacement_px;
  write("/x_px", "px", "column of the window centre, pixel centres at integers from 0",
        [&](std::size_t i) { return p[i].x; });
  write("/y_px", "px", "row of the window centre, downwards", [&](std::size_t i) { return p[i].y; });
  write("/u_px", "px", "displacement to the right, flow minus reference", [&](std::size_t i) { return d[i].x; });
  write("/v_px", "px", "displacement downwards, flow minus reference", [&](std::size_t i) { return d[i].y; });
  write("/sigma_u_px", "px", "estimated standard uncertainty of u", [&](std::size_t i) { return sigma(i).x; });
  write("/sigma_v_px", "px", "estimated standard uncertainty of v", [&](std::size_t i) { return sigma(i).y; });
  write("/peak_ratio", "1", "height of the highest correlation peak over that of the second highest", ratio);
  auto const write_codes = [&](char const* name, char const* description, auto const& value_of) {
    std::vector<std::int64_t> codes(count);
    for (std::size_t i = 0; i < count; ++i) codes[i] = value_of(i);
    file.write(name, std::span<std::int64_t const>(codes), {count}, "1", description, "vector");
  };
  write_codes("/status", "0 valid, 1 replaced, 2 masked, 3 invalid", status);
  write("/u_raw_px", "px", "displacement to the right before replacement", [&](std::size_t i) { return raw(i).x; });
  write("/v_raw_px", "px", "displacement downwards before replacement", [&](std::size_t i) { return raw(i).y; });
  write("/correlation", "1", "correlation coefficient of the peak at u_raw_px, v_raw_px", correlation);
  write_codes("/reason",
              "0 measured, 1 replaced by another peak, 2 replaced by the median of the neighbours, 3 masked, 4 no "
              "signal, 5 spurious and not replaced, 6 no peak in range, 7 uncorrelated, 8 moved out of the frames",
              reason);
  write_codes("/failed_test", "0 none, 1 median, 2 whole displacement, 3 peak ratio, 4 correlation", failed);
  write_codes("/ambiguous", "1 if another displacement has (nearly) the same correlation", ambiguous);
  if (!field.verdict.empty()) file.attribute("/", "verdict", field.verdict);
  file.attribute("/", "warnings", fmt::format("{}", fmt::join(field.warnings, "\n")));
  if (field.columns > 0) {
    file.attribute("/", "grid_columns", std::int64_t{field.columns});
    file.attribute("/", "grid_rows", std::int64_t{field.rows});
  }
  file.close();
}

}  // namespace gladstone
