#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/files/fields/readers/array_axes.h"
#include "render/files/fields/readers/array_file.h"

namespace gladstone::inline files {

/// Returns the name of a dataset without its groups.
std::string last_step(std::string const& path);

/// World axis and unit of an array of coordinates, as its name states them: "x_mm".
struct NamedCoordinate {
  char axis = 'x';
  std::string unit;  ///< unit; empty: not stated by the name
};
/// Returns the axis and unit of an array of coordinates (x, xcoor, x_coor, x_mm, x_m, x_um, x_cm, with any of x, y and
/// z in upper or lower case); nullopt for other names.
std::optional<NamedCoordinate> coordinate_name(std::string const& path);

/// Coordinates of the nodes along one axis of an array.
struct ArrayCoordinates {
  std::string dataset;
  std::vector<double> places;
  std::string unit;
  std::optional<std::size_t> axis = {};  ///< axis of the array, counted from the fastest, if the dataset determines it
};

/// Finds and reads the coordinates of an array of a file.
class CoordinateReader {
 public:
  /// @param file  must outlive this object
  /// @param path  the file, for errors
  /// @param name  the array
  CoordinateReader(ArrayFile const& file, std::string path, std::string name, ArrayAxes axes)
      : file_(file), path_(std::move(path)), name_(std::move(name)), axes_(std::move(axes)) {}

  /// Reads a dataset of coordinates; nullopt if it has no numbers, or a shape that is neither one axis nor the field's.
  /// @param unit  unit stated in the name of the dataset; empty: the unit is that of its attribute "units"
  /// @throws DataError if coordinates of all nodes vary along several axes
  std::optional<ArrayCoordinates> read(std::string const& dataset, std::string const& unit) const;

  /// Finds the coordinates along a world axis: in the group of the array, else in the nearest group above it.
  /// @param axis  'x', 'y' or 'z'
  /// @throws DataError as read()
  std::optional<ArrayCoordinates> find(char axis) const;

 private:
  /// Returns true if an array of coordinates has the shape of the field, apart from axes of length one.
  bool is_mesh(ArrayShape shape) const;
  /// Reduces coordinates of all nodes (a mesh grid) to those along the only axis on which they depend.
  /// @throws DataError if they vary along several axes
  void reduce_mesh(ArrayCoordinates& mesh, ArrayShape const& shape) const;

  ArrayFile const& file_;
  std::string path_, name_;
  ArrayAxes axes_;
};

}  // namespace gladstone::inline files
