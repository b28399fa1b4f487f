#include "analysis/vectors/vector_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "analysis/vectors/vector_readers/vector_readers.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"

namespace gladstone::inline vectors {
namespace {

/// Reader of a text format. Readers are tried in order; the last one accepts every table. A new format requires one
/// more row.
struct TextReader {
  bool (*recognizes)(TextTable const&);
  VectorFile (*read)(TextTable const&);
};
constexpr std::array<TextReader, 8> text_readers{{
    {is_gladstone_tecplot, read_gladstone_tecplot},
    {is_gladstone_csv, read_gladstone_csv},
    {is_pivlab, read_pivlab},
    {is_tecplot, read_tecplot},
    {is_dantec, read_dantec},
    {is_jpiv, read_jpiv},
    {is_openpiv, read_openpiv},
    {has_named_columns, read_named_columns},
}};

/// Reader of a format that is not text, selected by the extension of the file. A new format requires one more row.
struct BinaryReader {
  char const* extension;
  VectorFile (*read)(std::string const& path);
};
constexpr std::array<BinaryReader, 6> binary_readers{{
    {".h5", read_gladstone_hdf5},
    {".hdf5", read_gladstone_hdf5},
    {".nc", read_vector_netcdf},
    {".mat", read_vector_matlab},
    {".vti", read_vector_vtk},
    {".vtp", read_vector_vtk},
}};

/// Writer of a format, selected by the extension of the file. A new format requires one more row.
struct VectorWriter {
  char const* extension;
  void (*write)(std::string const& path, DisplacementField const& field, FileOrigin const& origin);
};
constexpr std::array<VectorWriter, 7> vector_writers{{
    {".h5", write_vector_hdf5},
    {".csv", write_vector_csv},
    {".nc", write_vector_netcdf},
    {".mat", write_vector_matlab},
    {".dat", write_vector_tecplot},
    {".vti", write_vector_vti},
    {".vtp", write_vector_vtp},
}};

/// Returns the writer for the extension of a file; null if there is none.
VectorWriter const* find_writer(std::string const& path) {
  auto const* const found = std::find_if(vector_writers.begin(), vector_writers.end(),
                                         [&](VectorWriter const& writer) { return path.ends_with(writer.extension); });
  return found == vector_writers.end() ? nullptr : found;
}

VectorFile read_text(std::string const& path) {
  TextTable const table = read_text_table(path);
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
  auto const* const reader = std::find_if(binary_readers.begin(), binary_readers.end(),
                                          [&](BinaryReader const& one) { return path.ends_with(one.extension); });
  VectorFile file = reader == binary_readers.end() ? read_text(path) : reader->read(path);
  arrange_as_grid(file.field);
  return file;
}

std::vector<std::string> vector_extensions() {
  std::vector<std::string> names;
  for (VectorWriter const& writer : vector_writers) names.emplace_back(writer.extension);
  return names;
}

bool has_vector_extension(std::string const& path) { return find_writer(path) != nullptr; }

void write_vectors(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  VectorWriter const* const writer = find_writer(path);
  if (!writer)
    throw OutputError(
        path, fmt::format("vectors are written as {}; use one of these endings", fmt::join(vector_extensions(), ", ")));
  writer->write(path, field, origin);
}

void override_conventions(VectorFile& file, std::string_view text) {
  VectorConventions const told = parse_conventions(text, file.conventions);
  if (specifies_reading(text)) {
    file.conventions = told;
    file.also.clear();
    return;
  }
  file.conventions.px = told.px;
  file.conventions.px_per_frame = told.px_per_frame;
  for (VectorConventions& other : file.also) {
    other.px = told.px;
    other.px_per_frame = told.px_per_frame;
  }
}

VectorFile convert_to_pixels(VectorFile file, std::string const& path) {
  bool const places = !file.place_unit.empty() && !file.conventions.px;
  bool const displacements = !file.displacement_unit.empty() && !file.conventions.px_per_frame;
  if (places || displacements) {
    std::string const what = (places ? "positions in " + file.place_unit : std::string()) +
                             (places && displacements ? " and " : "") +
                             (displacements ? "displacements in " + file.displacement_unit : std::string());
    throw DataError(ErrorCode::undetermined, path,
                    fmt::format("has {} (vectors are compared in px); give the size of a pixel in these units "
                                "with --conventions {}{}{}, or export px",
                                what, places ? "px=NUMBER" : "", places && displacements ? "," : "",
                                displacements ? "px/frame=NUMBER" : ""));
  }
  double const px = file.conventions.px.value_or(1.0), px_per_frame = file.conventions.px_per_frame.value_or(1.0);
  for (Vec2d& p : file.field.position_px) p = p / px;
  for (Vec2d& d : file.field.displacement_px) d = d / px_per_frame;
  for (Vec2d& d : file.field.sigma_px) d = d / px_per_frame;
  for (Vec2d& d : file.field.raw_px) d = d / px_per_frame;
  arrange_as_grid(file.field);
  return file;
}

Warnings read_warnings(Hdf5Reader const& file) {
  Warnings warnings;
  std::istringstream texts(file.attribute("warnings")), codes(file.attribute("warning_codes"));
  for (std::string text, line; std::getline(texts, text);) {
    std::getline(codes, line);
    std::size_t const blank = std::min(line.find(' '), line.size());
    std::string const place = line.substr(std::min(blank + 1, line.size()));
    if (!place.empty()) text.erase(0, place.size() + 2);
    warnings.push_back({find_warning_code(line.substr(0, blank)), place, text});
    line.clear();
  }
  return warnings;
}

}  // namespace gladstone::inline vectors
