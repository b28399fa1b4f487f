#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/readers/checked_source.h"
#include "render/files/fields/value_store.h"

namespace gladstone::inline files {

/// Location of the data of a VTK file: at the points of the grid, or in the cells between them.
enum class VtkPlace { points, cells };

/// The grid of a VTK file.
struct VtkGrid {
  std::array<int, 6> extent{};                       ///< index of the first and last point along i, j and k
  std::array<double, 3> origin{}, spacing{1, 1, 1};  ///< origin and spacing of an image
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<std::vector<double>, 3> coordinates;  ///< coordinates of the points of a rectilinear grid, along x, y and
                                                   ///< z

  /// Returns the number of points or cells of an extent along an axis; a single point counts as one cell.
  static int count(std::array<int, 6> const& extent, std::size_t axis, VtkPlace place);
};

/// Array of a VTK file, and the function that loads it.
struct VtkField {
  std::string name;
  VtkPlace place = VtkPlace::points;
  int significant_bits = 24;
  VtkGrid grid;
  Warnings notes;
  std::function<ValueStore()> load;  ///< reads all values in the order [k][j][i][component]
};

/// Checks the extent, origin and spacing of a grid with `values` numbers per node.
/// @throws DataError for a descending extent, a spacing of zero, or a size above 1e15 bytes
void check_grid(VtkGrid const& grid, int values, std::string const& path);

/// Creates the field of an array. @throws DataError if its axes (Direction) are not parallel to X, Y and Z
std::unique_ptr<CheckedSource> make_vtk_source(std::string const& path, VtkField field,
                                               FieldSelection const& selection);

/// Returns true for the arrays in which VTK and ParaView mark ghost points and cells; they are not fields.
inline bool marks_ghosts(std::string const& name) { return name == "vtkGhostType" || name == "vtkGhostLevels"; }

/// Returns the message that no array fits the selection. @param names  names of the existing arrays
std::string no_such_array(FieldSelection const& selection, std::vector<std::string> const& names);

}  // namespace gladstone::inline files
