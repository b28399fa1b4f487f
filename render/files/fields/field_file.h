#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/base/regular_grid.h"
#include "render/base/warning.h"
#include "render/files/fields/field_axes.h"
#include "render/files/fields/field_units.h"

namespace gladstone::inline files {

/// Gridded field in a file, with ascending world axes, x fastest, and uniform spacing. Values are read plane by plane;
/// they are all held in memory only if the file stores the axes in another order or with non-uniform spacing.
class FieldSource {
 public:
  virtual ~FieldSource() = default;

  /// Grid with spacing and origin in units().length; y points upwards.
  virtual RegularGrid const& grid() const = 0;
  virtual FieldUnits const& units() const = 0;
  /// Assignment of the file's axes to world axes.
  virtual AxisAssignment const& reading() const = 0;
  /// Returns warnings about assumptions, ignored information and the resampling error; may read the whole field.
  virtual Warnings notes() = 0;
  /// Name of the array in the file ("Density_0001"), for messages.
  virtual std::string const& name() const = 0;
  /// Number of values per node: 1 for a scalar field, 3 for a velocity.
  int values() const { return values_; }
  /// Number of significant bits of the stored values: 24 for float, 53 for double, the width of an integer.
  virtual int significant_bits() const = 0;
  /// Reads planes [first_plane, first_plane + count) of constant z as unconverted file values in full precision, in the
  /// order [z][y][x][component].
  /// @throws DataError for missing values (-999.9 in JHTDB), NaN and values beyond the range of float, with their
  ///         number, and for truncated data
  virtual void read_planes(int first_plane, int count, std::span<double> out) = 0;
  /// Reads rows [first_row, first_row + count) of one plane, like read_planes(), for planes too large for memory.
  virtual void read_rows(int plane, int first_row, int count, std::span<double> out) = 0;

 protected:
  explicit FieldSource(int values) : values_(values) {}

 private:
  int values_;
};

/// Returns the extensions of the formats that open_field() reads: ".h5", ".vti", ".npy", ...
std::vector<std::string> field_extensions();

/// Opens a field file by the format of its extension: HDF5, VTK, NRRD, MATLAB, NumPy, or a table of points (table in
/// field_file.cpp).
/// @param dataset  name of the array in the file; empty: the only suitable one
/// @param values   number of values per node: 1, or 3 for a velocity
/// @param axes     world axes in the order of the file, slowest first ("zxy"); empty: determined from the file
/// @throws DataError with the file, the dataset and a remedy
std::unique_ptr<FieldSource> open_field(std::string const& path, std::string const& dataset, int values = 1,
                                        std::string const& axes = "");

}  // namespace gladstone::inline files
