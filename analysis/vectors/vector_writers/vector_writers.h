#pragma once

#include <string>

#include "analysis/vectors/displacement_field.h"
#include "render/files/hdf5_file.h"

namespace gladstone::detail {

/// Writers of vectors, one per format. Positions and displacements are in px, y and v downwards, in every format; see
/// docs/file-formats.md. All write the file at once, after a check that the sources of `origin` have not changed.
/// @throws OutputError if the file cannot be written or the format cannot store the vectors; DataError if a source has
///         changed since it was read

/// vectors.h5: all quantities by vector, and those that are most used as grids with dimension scales.
void write_vector_hdf5(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// vectors.csv: one header line, 17 significant digits.
void write_vector_csv(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// netCDF-4 in the schema of PIVPy (github.com/alexlib/pivpy, io.from_arrays), u, v and chc over (y, x, t), for grids.
void write_vector_netcdf(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// MATLAB MAT-file of level 5 (MathWorks, "MAT-File Format", version 5): one matrix per quantity, of rows and columns
/// of the grid, or one column for scattered vectors.
void write_vector_matlab(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Tecplot ASCII, an ordered zone in POINT packing. Tecplot has no NaN: unknown values are 0.
void write_vector_tecplot(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// VTK XML image (.vti) with arrays at the points, for grids of uniform spacing.
void write_vector_vti(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// VTK XML polygonal data (.vtp) of one vertex per vector.
void write_vector_vtp(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Writes the bytes of a file at once, if no source has changed.
void write_vector_bytes(std::string const& path, std::string const& bytes, FileOrigin const& origin);

}  // namespace gladstone::detail
