#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "render/base/fields/field_axes.h"
#include "render/base/fields/field_units.h"

namespace gladstone {

/// The field that a user asks a reader for.
struct FieldWish {
  std::string dataset;  ///< its name in the file; empty: the only suitable one
  int values = 1;       ///< numbers at every node: 1, or 3 of a velocity
  std::string axes;     ///< world axes in the file's order, the slowest first; empty: as the file has them
};

/// A field as its file stores it: axes in the file's order and direction, three of them, a plane's slowest of one node.
/// Refuses values no field has: JHTDB's -999.9 where it has no data, nan and inf. Readers give the raw values; where
/// one is bad the whole field is read once more, to say how many there are.
class CheckedSource {
 public:
  CheckedSource(std::string path, std::string name, int values)
      : path_(std::move(path)), name_(std::move(name)), values_(values) {}
  virtual ~CheckedSource() = default;

  std::string const& path() const { return path_; }
  std::string const& name() const { return name_; }
  int values() const { return values_; }
  std::array<int, 3> const& nodes() const { return nodes_; }  ///< the fastest axis first
  StoredAxes const& axes() const { return axes_; }
  FieldUnits const& units() const { return units_; }
  FieldReading const& reading() const { return reading_; }
  std::vector<std::string> const& notes() const { return notes_; }
  virtual int significant_bits() const = 0;

  /// Rows [first_row, first_row + count) of a plane of the slowest axis. @throws DataError as FieldSource::read_planes
  void read_rows(int plane, int first_row, int count, std::span<double> out);
  /// Numbers in a row of the fastest axis.
  std::size_t row_values() const { return static_cast<std::size_t>(nodes_[0]) * static_cast<std::size_t>(values_); }

 protected:
  virtual void read_raw_rows(int plane, int first_row, int count, std::span<double> out) = 0;
  /// Sets nodes, and of reading() the shape and the names of the axes.
  /// @param rank axes that the file has, 2 or 3
  void describe(std::array<int, 3> const& nodes, std::size_t rank, std::string by);

  std::string path_, name_;
  int values_;
  std::array<int, 3> nodes_{1, 1, 1};
  StoredAxes axes_ = default_axes();
  FieldUnits units_;
  FieldReading reading_;
  std::vector<std::string> notes_;

 private:
  /// Where one of the values is bad, reads the field once more, to say how many are.
  void refuse_bad_values(std::span<double const> read);
};

}  // namespace gladstone
