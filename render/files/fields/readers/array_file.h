#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// File of named arrays of numbers, as open_array_field() reads it: HDF5, MATLAB, NumPy or columns of a table. Shapes
/// list the slowest axis first.
class ArrayFile {
 public:
  virtual ~ArrayFile() = default;

  /// Returns the names of all arrays, "group/name".
  virtual std::vector<std::string> names() const = 0;
  /// Returns the entries that hold no real numbers, with what they hold, for messages.
  virtual std::vector<std::string> describe_others() const = 0;
  virtual bool has(std::string const& array) const = 0;
  /// @throws DataError that lists the arrays if no array has this name
  virtual std::vector<std::size_t> shape(std::string const& array) const = 0;
  /// Number of significant bits of the stored numbers: 24 for float, 53 for double, the width of an integer.
  virtual int significant_bits(std::string const& array) const = 0;
  virtual std::vector<double> read(std::string const& array) const = 0;
  /// Reads a box of an array; `out` has exactly its size, the last axis varies fastest.
  virtual void read_box(std::string const& array, std::vector<std::size_t> const& start,
                        std::vector<std::size_t> const& size, std::span<double> out) const = 0;
  /// Returns an attribute of an array; empty if there is none.
  virtual std::string attribute(std::string const& array, std::string const& name) const = 0;
  virtual std::vector<double> number_attribute(std::string const& array, std::string const& name) const = 0;
  /// Returns the array of coordinates and the label of each axis; "" for axes without one.
  virtual std::vector<std::string> dimension_scales(std::string const& array) const = 0;
  virtual std::vector<std::string> dimension_labels(std::string const& array) const = 0;
  /// Returns warnings about parts of the file that are ignored.
  virtual Warnings notes() const { return {}; }
};

/// Opens an array of a file as a field.
///
/// - Shapes: [nz, ny, nx] or [ny, nx], with additional axes of length one at any position; the components of a velocity
///   are the last or the first axis, or separate arrays (join_velocities()).
/// - Coordinates: the dimension scales of netCDF-4, else arrays xcoor, x, X, x_mm, x_m, x_um ... in the group of the
///   array or above it, in the unit of their name or of their attribute "units". They have one axis, or the shape of
///   the field (meshgrid) and vary along one axis. Coordinates of n + 1 edges along each axis make the field one of
///   cells. Without coordinates the spacing is 1.
/// - Order of axes: that of the caller, else that of the dimension scales, else that of the dimension labels, else that
///   of coordinates of the shape of the field, else z, y, x if the lengths of the coordinates allow it, else the only
///   order that they allow.
/// - Values: attributes scale_factor, add_offset, _FillValue and missing_value (CF Conventions) are applied; missing
///   values become NaN.
/// @throws DataError for shapes that are not a field, and coordinates of the wrong length or of a curved grid
std::unique_ptr<CheckedSource> open_array_field(std::unique_ptr<ArrayFile const> file, std::string const& path,
                                                FieldSelection const& selection);

}  // namespace gladstone::inline files
