#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone::inline files {

/// Array at the points of a VTK file.
struct VtkPointArray {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;  ///< values at the points, in the order of the points
};

/// Points of a VTK file and the numbers at them.
struct VtkPoints {
  std::vector<double> positions;  ///< x, y, z of each point
  std::vector<VtkPointArray> arrays;
};

/// Reads the points of a VTK image (.vti, ImageData) or of polygonal data (.vtp, PolyData) in XML, in the encodings of
/// open_vtk_xml(). Pieces of polygonal data follow each other; an image must have one piece and axes along x, y and z.
/// @param wanted  kind of file expected, for messages: "a file of vectors"
/// @throws DataError for unsupported features and for truncated or damaged data
VtkPoints read_vtk_points(std::string const& path, std::string const& wanted);

}  // namespace gladstone::inline files
