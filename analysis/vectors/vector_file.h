#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/warning.h"
#include "render/files/hdf5_file.h"

namespace gladstone::inline vectors {

/// Conversion from the numbers of a vector file to our conventions: column to the right and row downwards from 0 at the
/// first pixel's centre, displacement = frame B minus frame A (BOS: measurement minus reference), v downwards.
/// The steps are: exchange the columns; positions, in the file's axes: x = x_file/px + offset, y' = y_file/px + offset,
/// y = mirror - y' if y_up; displacements: u = u_file/px_per_frame, v = v_file/px_per_frame, negated if v_up; finally
/// both components change their sign if `swapped` is true.
struct VectorConventions {
  enum class Mirror {
    grid,   ///< mirrored about the centre of the vector grid: mirror = y' min + y' max (OpenPIV's
            ///< transform_coordinates)
    image,  ///< mirrored about the centre of the image: mirror = rows - 1
  };
  /// Pairs of columns that are exchanged.
  enum class Exchange { none, places, components, axes };  ///< none, x with y, u with v, both pairs

  bool y_up = false;  ///< true if y increases upwards
  bool v_up = false;  ///< true if v is positive upwards
  /// True if the frames were exchanged, so that the displacement is that from frame B to frame A.
  bool swapped = false;
  /// Our coordinate minus that of the file [px]; -0.5 for software that reports x = ws/2 (ws: window size), -1 for
  /// 1-based pixels.
  double offset_px = 0.0;
  Mirror mirror = Mirror::grid;
  Exchange exchange = Exchange::none;
  std::optional<double> px{};            ///< size of a pixel, in the file's unit of position
  std::optional<double> px_per_frame{};  ///< displacement of one pixel, in the file's unit of displacement

  bool exchanges_places() const { return exchange == Exchange::places || exchange == Exchange::axes; }
  bool exchanges_components() const { return exchange == Exchange::components || exchange == Exchange::axes; }

  friend bool operator==(VectorConventions const&, VectorConventions const&) = default;
};

/// Parses conventions: a comma-separated list of y-down, y-up (about the grid), y-up-image, v-down, v-up,
/// frames-exchanged (or swapped), axes-exchanged, places-exchanged, components-exchanged, offset=NUMBER, px=NUMBER,
/// px/frame=NUMBER.
/// @param from  values of the properties that the text does not mention
/// @throws std::invalid_argument for an invalid word, which the message contains
VectorConventions parse_conventions(std::string_view text, VectorConventions from = {});
/// Returns all conventions in the words of parse_conventions(), for example "y-up,v-up,offset=-0.5".
std::string describe(VectorConventions const& conventions);

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

/// Returns true if the words specify axes, signs or positions rather than only the size of a pixel.
bool specifies_reading(std::string_view text);
/// Replaces the format's default conventions by those of the words, see parse_conventions(). Unless only the size of a
/// pixel is given, the format's alternatives are discarded.
void override_conventions(VectorFile& file, std::string_view text);

/// Converts positions and displacements to px, with `px` and `px_per_frame` of the file's conventions.
/// @throws DataError if the file states other units and its conventions do not define the size of a pixel in them
VectorFile convert_to_pixels(VectorFile file, std::string const& path);

/// Converts vectors to our conventions; vectors on a complete lattice are sorted in our order.
/// @pre the vectors are in px
/// @param image_rows  number of rows of the image, for Mirror::image
DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows);

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
