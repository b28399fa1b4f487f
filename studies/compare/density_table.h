#pragma once

#include <string>

#include "analysis/vectors/grid_table.h"
#include "render/files/hdf5_axes.h"
#include "studies/compare/reconstruct.h"
#include "studies/compare/tomography.h"

namespace gladstone::inline compare {

/// Returns density, uncertainty, region and reference at the nodes of a plane, and for a rendered case truth and error.
GridTable make_density_table(Reconstruction const& reconstruction);

/// Adds the gradient as columns gradient_x_kg_m4 and gradient_y_kg_m4, which density.h5 stores as one dataset.
void add_gradient_columns(GridTable& table, std::vector<Vec2d> const& gradient);

/// Returns the density of a volume and the number of views at its nodes, and for rendered cases truth and error.
GridTable make_volume_table(Tomography const& result);

/// Returns the axes z, y, x of a volume.
std::vector<TableAxis> make_volume_axes(RegularGrid const& grid);

/// Writes the coordinates /x_mm, /y_mm (and /z_mm) and a dataset for each column, with named axes.
/// @param order  meaning of the axes of the datasets
void write_grid_datasets(Hdf5Writer& file, Hdf5Axes& axes, GridTable const& table, std::string const& order);

/// Returns the file extensions that `gladstone reconstruct` and `tomography` write: .h5 and those of
/// grid_table_extensions().
/// @throws OutputError if a path has another extension
void require_density_ending(std::string const& path);

/// Returns true for density.h5 of a plane, and for the HDF5 file of a volume.
bool is_density_file(std::string const& path);

/// Densities of a file, with the provenance that a converted file stores.
struct ExportedDensity {
  GridTable table;
  FileOrigin origin;
  std::string format;  ///< "gladstone density", "gladstone tomography" or "gladstone volume"
};

/// Reads a density file for a file in another format. @throws DataError if it cannot be read
ExportedDensity load_density_for_export(std::string const& path);

}  // namespace gladstone::inline compare
