#pragma once

#include <string>
#include <vector>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Coordinates of a uniform axis of a grid.
struct TableAxis {
  std::string name;              ///< "x", "y" or "z"
  std::vector<double> place_mm;  ///< coordinates in ascending order [mm]
  std::string description;
};

/// Scalar quantities at the nodes of a grid in a plane or a volume, such as a density and its uncertainty.
struct GridTable {
  /// Axes in the order y, x or z, y, x: the index of the last axis varies fastest.
  std::vector<TableAxis> axes;
  /// Quantities, with one value per node; the x index varies fastest; NaN: unknown.
  std::vector<VectorColumn> columns;

  /// Returns the number of nodes along each axis.
  std::vector<std::size_t> shape() const;
  std::size_t nodes() const;
};

/// Returns the extensions of the formats that write_grid_table() writes.
std::vector<std::string> grid_table_extensions();

/// Writes quantities in the format of the extension: table (.csv), netCDF-4 with named coordinates (.nc), MATLAB level
/// 5
/// (.mat) or VTK image (.vti); contents in docs/file-formats.md.
/// @throws OutputError, also for another extension; DataError if a source has changed since it was read
void write_grid_table(std::string const& path, GridTable const& table, FileOrigin const& origin);

}  // namespace gladstone::inline vectors
