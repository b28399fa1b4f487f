#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/field_axes.h"
#include "render/files/fields/field_units.h"

namespace gladstone::inline files {

/// Selection of a field in a file.
struct FieldSelection {
  std::string dataset;  ///< name of the array in the file; empty: the only suitable one
  int values = 1;       ///< number of values per node: 1, or 3 for a velocity
  std::string axes;     ///< world axes in the order of the file, slowest first; empty: determined from the file
};

/// Field with axes in the order and direction of its file; a two-dimensional field has a third, slowest axis of one
/// node. Refuses missing values (-999.9 in JHTDB), NaN and values beyond the range of float. If a bad value is found,
/// the whole field is read once more to count them.
class CheckedSource {
 public:
  CheckedSource(std::string path, std::string name, int values)
      : path_(std::move(path)), name_(std::move(name)), values_(values) {}
  virtual ~CheckedSource() = default;

  std::string const& path() const { return path_; }
  std::string const& name() const { return name_; }
  int values() const { return values_; }
  std::array<int, 3> const& nodes() const { return nodes_; }  ///< nodes along each axis, fastest first
  StoredAxes const& axes() const { return axes_; }
  FieldUnits const& units() const { return units_; }
  AxisAssignment const& reading() const { return reading_; }
  Warnings const& notes() const { return notes_; }
  virtual int significant_bits() const = 0;

  /// Reads rows [first_row, first_row + count) of a plane of the slowest axis.
  /// @throws DataError as FieldSource::read_planes()
  void read_rows(int plane, int first_row, int count, std::span<double> out);
  /// Number of values in a row of the fastest axis: nodes x values per node.
  std::size_t row_values() const { return static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(values_); }

 protected:
  /// Reads rows as read_rows(), without checking the values.
  virtual void read_raw_rows(int plane, int first_row, int count, std::span<double> out) = 0;
  /// Sets the nodes, the shape and axis names of reading() and units().unspaced, from axes_.
  /// @param rank  number of axes in the file, 2 or 3
  /// @param by    source of the assignment of axes
  void describe(std::array<int, 3> const& nodes, std::size_t rank, std::string by);

  std::string path_, name_;
  int values_;
  std::array<int, 3> nodes_{1, 1, 1};
  StoredAxes axes_ = default_axes();
  FieldUnits units_;
  AxisAssignment reading_;
  Warnings notes_;

 private:
  /// Throws DataError if one of the values is bad, after counting the bad values of the whole field.
  void refuse_bad_values(std::span<double const> read);
};

}  // namespace gladstone::inline files
