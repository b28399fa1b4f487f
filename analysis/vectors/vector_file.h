#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "analysis/vectors/vector_conventions.h"
#include "render/base/warning.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Vectors of a file, not yet converted to our conventions.
struct VectorFile {
  DisplacementField field;  ///< vectors with the numbers of the file
  /// Name of the format: "gladstone", "OpenPIV", "PIVlab", "DaVis", "Insight", "JPIV", "named columns", ...
  std::string format;
  VectorConventions conventions;          ///< default conventions of the program that writes the format
  bool foreign = true;                    ///< true: written by another program; false: written by gladstone
  std::vector<VectorConventions> also{};  ///< alternative conventions of the program that writes the format
  std::string place_unit{};               ///< unit of the positions as stated in the file; empty: px
  std::string displacement_unit{};        ///< unit of the displacements as stated in the file; empty: px
  Warnings warnings{};                    ///< warnings about assumptions and ignored parts of the file
  std::vector<std::string> notes{};       ///< remarks about columns that are not used
  bool complete = true;                   ///< false: the header declares another number of vectors; see `warnings`
};

/// Reads every format that write_vectors() writes, data sets of PIVPy (.nc), text files of OpenPIV, PIVlab, DaVis, TSI
/// Insight, Dantec and JPIV, or any text file with a header line that names columns x, y, u, v (or vx, vy), with or
/// without units. Separators are comma, semicolon, tab or blanks; the decimal separator may be a comma. Text may be
/// UTF-8 or UTF-16. Vectors on a complete lattice are sorted row by row from the smallest y, and `columns` and `rows`
/// are set.
/// @throws DataError with file:line for content that cannot be read
VectorFile read_vectors(std::string const& path);

/// Returns the warnings that write_vectors() stored in an HDF5 file; those of earlier versions have no code.
Warnings read_warnings(Hdf5Reader const& file);

/// Replaces the format's default conventions by those of the words, see parse_conventions(). Unless only the size of a
/// pixel is given, the format's alternatives are discarded.
void override_conventions(VectorFile& file, std::string_view text);

/// Converts positions and displacements to px, with `px` and `px_per_frame` of the file's conventions.
/// @throws DataError if the file states other units and its conventions do not define the size of a pixel in them
VectorFile convert_to_pixels(VectorFile file, std::string const& path);

/// Returns the extensions of the formats that write_vectors() writes: ".h5", ".csv", ".nc", ...
std::vector<std::string> vector_extensions();
/// Returns true if a path ends in one of vector_extensions().
bool has_vector_extension(std::string const& path);

/// Writes vectors in the format that the extension selects: vectors.h5 (.h5), vectors.csv (.csv), netCDF-4 in the
/// schema of PIVPy (.nc), MATLAB level 5 (.mat), Tecplot ASCII (.dat), VTK image (.vti) or VTK points (.vtp); contents
/// in docs/file-formats.md. Quantities that were not estimated are NaN (Tecplot: 0, marked by the column `unknown`).
/// @throws OutputError, also for scattered vectors in .nc and .vti; DataError if a source has changed since it was
/// read;
///         std::invalid_argument for another file extension
void write_vectors(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Selects vectors by index, in the given order; the result is scattered (columns = rows = 0).
void take_vectors(DisplacementField& field, std::vector<std::size_t> const& order);

/// Sorts vectors row by row from the smallest y, with x ascending, and sets columns and rows if the positions are a
/// complete lattice (within 0.01 px). Otherwise sets columns and rows to 0 and preserves the order.
void arrange_as_grid(DisplacementField& field);

}  // namespace gladstone::inline vectors
