#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "analysis/vectors/vector_readers/own_columns.h"
#include "analysis/vectors/vector_readers/vector_readers.h"
#include "render/files/fields/readers/vtk_points.h"

namespace gladstone::inline vectors {
namespace {

/// Array of two columns, as the components of vectors in three dimensions.
struct JoinedColumns {
  char const* array;
  std::array<char const*, 2> columns;
};
constexpr std::array joined_columns{JoinedColumns{"position_px", {"x_px", "y_px"}},
                                    JoinedColumns{"displacement_px", {"u_px", "v_px"}},
                                    JoinedColumns{"sigma_px", {"sigma_u_px", "sigma_v_px"}},
                                    JoinedColumns{"raw_displacement_px", {"u_raw_px", "v_raw_px"}}};

std::vector<double> pick_component(std::vector<double> const& values, std::size_t components, std::size_t component) {
  std::vector<double> picked;
  picked.reserve(values.size() / components);
  for (std::size_t i = component; i < values.size(); i += components) picked.push_back(values[i]);
  return picked;
}

}  // namespace

VectorFile read_vector_vtk(std::string const& path) {
  VtkPoints points = read_vtk_points(path, "a file of vectors");
  OwnColumns columns{path};
  // An image has the array position_px only if its origin and spacing do not give the positions to the last bit.
  points.arrays.insert(points.arrays.begin(), VtkPointArray{"position_px", 3, std::move(points.positions)});
  for (VtkPointArray const& array : points.arrays) {
    auto const* const joined = std::find_if(joined_columns.begin(), joined_columns.end(),
                                            [&](JoinedColumns const& one) { return one.array == array.name; });
    if (joined == joined_columns.end()) {
      if (array.components == 1 && is_own_column(array.name)) columns.values[array.name] = array.values;
    } else if (array.components >= 2) {
      for (std::size_t i = 0; i < 2; ++i)
        columns.values[joined->columns[i]] = pick_component(array.values, array.components, i);
    }
  }
  return read_own_columns(columns);
}

}  // namespace gladstone::inline vectors
