#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/base/fields/field_axes.h"
#include "render/base/fields/field_units.h"
#include "render/base/regular_grid.h"

namespace gladstone {

/// A gridded field in a file, before its values are read: x, y and z ascend, x is fastest, nodes are uniform. Values
/// are read slab by slab; only where the file has its axes in another order, or not uniform, are they all held in
/// memory.
class FieldSource {
 public:
  virtual ~FieldSource() = default;

  /// Nodes, spacing and origin as the file has them, in units().length; the y index runs upwards.
  virtual RegularGrid const& grid() const = 0;
  virtual FieldUnits const& units() const = 0;
  /// Which axis of the file is taken for which.
  virtual FieldReading const& reading() const = 0;
  /// Warnings: what had to be assumed or ignored, and what resampling changes; may read the whole field.
  virtual std::vector<std::string> notes() = 0;
  /// What the numbers are called in the file ("Density_0001"), for messages.
  virtual std::string const& name() const = 0;
  /// Numbers at every node: 1 of a scalar field, 3 of a velocity.
  int values() const { return values_; }
  /// Bits of precision of the stored numbers: 24 for float, 53 for double, an integer's width.
  virtual int significant_bits() const = 0;
  /// Reads planes [first_plane, first_plane + count) of constant z, x fastest but for the values of a node, which
  /// stand together; as raw file values with all their digits.
  /// @throws DataError for holes (JHTDB's -999.9) and numbers that are NaN or beyond a float, with their count, and for
  ///         truncated data
  virtual void read_planes(int first_plane, int count, std::span<double> out) = 0;
  /// The same of rows [first_row, first_row + count) of one plane, for planes that are too large to be held.
  virtual void read_rows(int plane, int first_row, int count, std::span<double> out) = 0;

 protected:
  explicit FieldSource(int values) : values_(values) {}

 private:
  int values_;
};

/// Opens a field file: one row per format in field_file.cpp (HDF5, VTK, NRRD).
/// @param dataset name inside the file; empty: the only suitable one
/// @param values  numbers at every node: 1, or 3 of a velocity
/// @param axes    world axes in the file's order, the slowest first ("zxy"); empty: as the file has them
/// @throws DataError naming the file, the dataset and what to do
std::unique_ptr<FieldSource> open_field(std::string const& path, std::string const& dataset, int values = 1,
                                        std::string const& axes = "");

}  // namespace gladstone
