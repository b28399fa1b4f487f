#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Displacements in three components at the nodes of a grid on a laser sheet, as gladstone stereo writes them. Axes are
/// those of the world, lengths are in mm; NaN: not determined.
struct ThreeComponentField {
  std::vector<double> x_mm, y_mm;  ///< positions of the columns and of the rows, which are stored from the lowest y
  std::vector<double> z_mm;        ///< z of every node [mm]
  std::vector<Vec3d> displacement_mm, sigma_mm;
  std::vector<double> residual_px;     ///< root of the sum of squares of the four equations' residuals [px]
  std::vector<double> residual_ratio;  ///< residual divided by its standard uncertainty [1]
  std::vector<VectorStatus> status;    ///< valid or invalid

  std::size_t size() const { return displacement_mm.size(); }
};

/// Returns whether gladstone stereo has written a file; always false if the name does not have an extension of HDF5.
bool is_three_component_file(std::string const& path);

/// Reads a file of gladstone stereo.
/// @throws DataError if a dataset is missing, or has another shape than the grid
ThreeComponentField read_three_components(std::string const& path);

/// Returns the extensions of the formats that write_three_components() writes.
std::vector<std::string> three_component_extensions();

/// Writes displacements with three components in the format that the extension selects: table (.csv), netCDF-4 in the
/// schema of PIVPy with `w` (.nc), MATLAB level 5 (.mat), Tecplot ASCII (.dat), VTK image (.vti) or VTK points (.vtp);
/// contents in docs/file-formats.md.
/// @throws OutputError; DataError if a source has changed since it was read;
///         std::invalid_argument for another file extension
void write_three_components(std::string const& path, ThreeComponentField const& field, FileOrigin const& origin);

}  // namespace gladstone::inline vectors
