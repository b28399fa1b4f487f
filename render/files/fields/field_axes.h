#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline files {

/// Spatial axis of an array as stored in its file.
struct StoredAxis {
  char world = 'x';                 ///< world axis assigned to the stored axis: 'x', 'y' or 'z'
  double first = 0;                 ///< coordinate of the first node [length unit of the file]
  double step = 1;                  ///< distance between nodes [length unit of the file]; negative if the axis is
                                    ///< stored in descending order
  std::vector<double> coordinates;  ///< coordinates of all nodes if they are not uniform; empty: first + i step
  bool stated = false;              ///< true: the file states the distance between nodes
};

/// The three axes of a stored array, fastest-varying first.
using StoredAxes = std::array<StoredAxis, 3>;

/// Returns the default order of axes: x fastest, z slowest.
inline StoredAxes default_axes() {
  StoredAxes axes;
  for (std::size_t axis = 0; axis < 3; ++axis) axes[axis].world = "xyz"[axis];
  return axes;
}

/// Assignment of an array's axes to world axes, and its reason.
struct AxisAssignment {
  std::string axes = "zyx";              ///< world axes in the order of the file, slowest first
  std::string by = "the default order";  ///< source of the order
  std::vector<std::size_t> shape;        ///< number of nodes along each axis, in the order of `axes`
  std::string turned_round;              ///< world axes stored in descending order: "xy"

  /// Describes the assignment: "[16, 20, 24] is read as z, y, x (by its coordinates); y descends in the file and is
  /// reversed".
  std::string text() const;
};

/// Returns true if a text consists of two or three different letters of x, y and z.
bool is_axis_order(std::string_view axes);

/// Assigns world axes to the stored axes in the order given by the user.
/// @param axes  world axes, slowest first, "zxy"; empty: no change
/// @param rank  number of axes of the stored array, 2 or 3
/// @throws DataError if `axes` is not an order of `rank` axes
void name_axes(StoredAxes& stored, std::string const& axes, std::size_t rank, std::string const& path);

/// Builds an axis from the ascending or descending coordinates of its nodes. It is uniform if the coordinates deviate
/// by less than 1e-4 of a step plus two units in the last place of a float; otherwise the coordinates are stored.
/// @throws DataError naming `what` if the coordinates are not finite or not monotonic
StoredAxis axis_from_coordinates(std::vector<double> coordinates, std::string const& path, std::string const& what);

}  // namespace gladstone::inline files
