#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "render/base/fields/readers/checked_source.h"
#include "render/base/fields/value_store.h"

namespace gladstone {

/// Data of a VTK file belong to the points of its grid, or to the cells between them.
enum class VtkPlace { points, cells };

/// The grid of a VTK file.
struct VtkGrid {
  std::array<int, 6> extent{};                       ///< first and last point along i, j, k
  std::array<double, 3> origin{}, spacing{1, 1, 1};  ///< of an image
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<std::vector<double>, 3> coordinates;  ///< of the points of a rectilinear grid

  /// Points, or cells, along an axis of an extent.
  static int count(std::array<int, 6> const& extent, std::size_t axis, VtkPlace place);
};

/// An array of a VTK file.
struct VtkField {
  std::string name;
  VtkPlace place = VtkPlace::points;
  int significant_bits = 24;
  VtkGrid grid;
  std::vector<std::string> notes;
  std::function<ValueStore()> load;  ///< reads all values, x fastest but for the components of a node
};

/// Checks extent and spacing of a grid of so many values a node.
/// @throws DataError for extents that do not ascend, spacings of zero and grids that are larger than any field
void check_grid(VtkGrid const& grid, int values, std::string const& path);

/// The field of an array. @throws DataError for turned axes (Direction) that are not along X, Y and Z
std::unique_ptr<CheckedSource> make_vtk_source(std::string const& path, VtkField field, FieldWish const& wish);

/// A message that no array is the one wanted. @param names of the arrays that are there
std::string no_such_array(FieldWish const& wish, std::vector<std::string> const& names);

}  // namespace gladstone
