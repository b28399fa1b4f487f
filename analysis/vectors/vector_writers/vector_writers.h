#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "analysis/vectors/vector_writers/vector_columns.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Writers of vectors, one per format. Positions and displacements are in px, y and v downwards, in every format; see
/// docs/file-formats.md. All write the file at once, after a check that the sources of `origin` have not changed.
/// @throws OutputError if the file cannot be written or the format cannot store the vectors; DataError if a source has
///         changed since it was read

/// Writes vectors.h5: all quantities in one dataset each, one value per vector, and the most used ones also as grids
/// with dimension scales.
void write_vector_hdf5(std::string const& path, DisplacementField const& field, FileOrigin const& origin);
/// Writes vectors.h5 with columns in addition to those of write_vector_hdf5().
void write_vector_columns(std::string const& path, DisplacementField const& field, std::vector<VectorColumn> more,
                          FileOrigin const& origin);

/// Writes vectors.csv with one header line and 17 significant digits.
void write_vector_csv(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes vectors on a grid as netCDF-4 in the schema of PIVPy (github.com/alexlib/pivpy, io.from_arrays): u, v and chc
/// over (y, x, t).
void write_vector_netcdf(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes a MATLAB MAT-file of level 5 (MathWorks, "MAT-File Format", version 5) with one matrix per quantity. A matrix
/// has the rows and columns of the grid, or one column for scattered vectors.
void write_vector_matlab(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes Tecplot ASCII, an ordered zone in POINT packing. Tecplot has no NaN: unknown values are written as 0, and the
/// column `unknown` contains the sum of 2^k over all columns k whose value is unknown.
void write_vector_tecplot(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes a VTK XML image (.vti) with arrays at the points, for grids of uniform spacing. The positions are also
/// written as an array if origin and spacing do not reproduce them to the last bit.
void write_vector_vti(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes VTK XML polygonal data (.vtp) with one vertex per vector.
void write_vector_vtp(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writers of tables, for two and three components alike.
void write_csv_table(std::string const& path, VectorTable const& table, FileOrigin const& origin);
void write_tecplot_table(std::string const& path, VectorTable const& table, FileOrigin const& origin);
void write_matlab_table(std::string const& path, VectorTable const& table, FileOrigin const& origin);

/// Axes of a netCDF file.
struct NetcdfAxes {
  VectorGrid grid;
  std::string units;  ///< units of x and y
  std::string x_description, y_description;
};
/// Variable of a netCDF file: its name, the column that it stores, and its attributes.
struct NetcdfVariable {
  char const* name;
  char const* column;
  char const* units;
  char const* long_name;
  char const* standard_name;  ///< attribute standard_name; empty: none
};
/// Writes the variables and `chc`, the validity according to the column "status".
void write_netcdf_table(std::string const& path, VectorTable const& table, NetcdfAxes const& axes,
                        std::span<NetcdfVariable const> variables, FileOrigin const& origin);

/// Columns that form the components of one vector quantity of a VTK file.
struct VtkVectors {
  std::string name;
  std::array<std::string, 3> components;  ///< names of the columns; empty: the component is 0
};
struct VtkLayout {
  VtkVectors position;              ///< positions of the points in .vtp; each other column is a separate array
  std::vector<VtkVectors> vectors;  ///< vector quantities, the displacement first
};
void write_vti_table(std::string const& path, VectorTable const& table, VectorGrid const& grid, VtkLayout const& layout,
                     FileOrigin const& origin);
/// Writes a VTK image of scalars at the points of a uniform grid.
/// @param places  coordinates of the points along x, y and z
void write_vti_scalars(std::string const& path, std::vector<VectorColumn> const& columns,
                       std::array<std::vector<double>, 3> const& places, std::string const& remark,
                       FileOrigin const& origin);
void write_vtp_table(std::string const& path, VectorTable const& table, VtkLayout const& layout,
                     FileOrigin const& origin);

/// Writes the bytes of a file at once, if no source has changed.
void write_vector_bytes(std::string const& path, std::string const& bytes, FileOrigin const& origin);

}  // namespace gladstone::inline vectors
