#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone {

/// One spatial axis of an array as its file stores it.
struct StoredAxis {
  char world = 'x';                 ///< world axis it is taken for: 'x', 'y' or 'z'
  double first = 0;                 ///< coordinate of its first node [the file's unit of length]
  double step = 1;                  ///< from one node to the next; negative: the axis runs backwards
  std::vector<double> coordinates;  ///< of every node, where they are not uniform; empty: first + i step
};

/// The three axes of a stored array, the fastest first.
using StoredAxes = std::array<StoredAxis, 3>;

/// x fastest, z slowest.
inline StoredAxes default_axes() {
  StoredAxes axes;
  for (std::size_t axis = 0; axis < 3; ++axis) axes[axis].world = "xyz"[axis];
  return axes;
}

/// Which axis of the stored array is taken for which world axis, and why.
struct FieldReading {
  std::string axes = "zyx";              ///< world axes in the order of the file, the slowest first
  std::string by = "the default order";  ///< what determined the order
  std::vector<std::size_t> shape;        ///< nodes in the same order
  std::string turned_round;              ///< world axes that run backwards in the file: "xy"

  /// "[16, 20, 24] is read as z, y, x (by its coordinates); y runs backwards and is turned round"
  std::string text() const;
};

/// Whether a text names two or three different axes of x, y and z.
bool is_axis_order(std::string_view axes);

/// Takes the stored axes for those that the user names, the slowest first.
/// @param axes  names of the stored axes, "zxy"; empty: changes nothing
/// @param rank  axes of the array as stored, 2 or 3
/// @throws DataError if the names do not fit the number of axes
void name_axes(StoredAxes& stored, std::string const& axes, std::size_t rank, std::string const& path);

/// An axis from the coordinates of its nodes: uniform to 1e-4 of a step beyond what float coordinates resolve, or with
/// all of them. They may descend.
/// @throws DataError naming `what`, where they are not finite, or neither ascend nor descend
StoredAxis axis_from_coordinates(std::vector<double> coordinates, std::string const& path, std::string const& what);

}  // namespace gladstone
