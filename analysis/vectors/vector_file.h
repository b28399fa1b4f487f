#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/hdf5_file.h"

namespace gladstone {

/// How the numbers of a vector file relate to ours (column right and row down from 0 at the first pixel's centre,
/// displacement = flow minus reference, v down). Positions first, in the file's own axes:
/// x = x_file + offset, y' = y_file + offset, then y = mirror - y' if y_up; displacements: v = -v_file if v_up,
/// then both change sign if swapped.
struct VectorConventions {
  enum class Mirror {
    grid,   ///< about the middle of the vector grid: y' min + y' max (OpenPIV's transform_coordinates)
    image,  ///< about the middle of the image: rows - 1
  };

  bool y_up = false;       ///< y grows upwards
  bool v_up = false;       ///< v counts upwards
  bool swapped = false;    ///< reference minus flow: the frames were exchanged
  double offset_px = 0.0;  ///< ours minus the file's coordinates; -0.5 for codes that report x = ws/2, -1 for 1-based
  Mirror mirror = Mirror::grid;

  friend bool operator==(VectorConventions const&, VectorConventions const&) = default;
};

/// As the user tells it: words separated by commas out of y-down, y-up (about the grid), y-up-image, v-down, v-up,
/// swapped, offset=NUMBER; what is left unsaid is as in `from`. @throws std::invalid_argument naming the word
VectorConventions parse_conventions(std::string_view text, VectorConventions from = {});
/// The same words, complete: "y-up,v-up,offset=-0.5".
std::string describe(VectorConventions const& conventions);

/// Vectors as they stand in a file.
struct VectorFile {
  DisplacementField field;        ///< numbers as written; positions and displacements in px
  std::string format;             ///< "gladstone", "OpenPIV", "PIVlab", "named columns"
  VectorConventions conventions;  ///< what the format's own program writes by default
  bool foreign = true;            ///< false: ours, nothing to detect
};

/// Reads vectors.h5 or vectors.csv of ours; OpenPIV's text (# x y u v flags mask; x y u v mask of older versions;
/// openpiv-cxx's x y u v flag); PIVlab's ASCII export in px; any text with a header line of columns x, y, u, v.
/// Separators: comma, semicolon, tab or blanks. A complete lattice of vectors is put in our order (row by row from
/// the smallest y) and `columns`, `rows` are set.
/// @throws DataError with file:line for what cannot be read, calibrated exports included
VectorFile read_vectors(std::string const& path);

/// Vectors in our conventions; grids come back in our order.
/// @param image_rows for Mirror::image
DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows);

/// Writes vectors.h5 (path ends in .h5) or vectors.csv: x_px, y_px, u_px, v_px, sigma_u_px, sigma_v_px, peak_ratio,
/// status, u_raw_px, v_raw_px, correlation, reason, ambiguous; what was not estimated is NaN. CSV has one header line
/// and 17 significant digits. A .h5 carries the verdict, the warnings and the hashes of its sources; plain numbers
/// cannot.
/// @throws OutputError; DataError where a source has changed since it was read; std::invalid_argument for another
/// ending
void write_vectors(std::string const& path, DisplacementField const& field, FileOrigin const& origin);

/// Keeps the vectors of these indices, in this order, as scattered ones.
void take_vectors(DisplacementField& field, std::vector<std::size_t> const& order);

/// Where the positions are a complete lattice (to 0.01 px), puts the vectors row by row from the smallest y, x
/// ascending, and sets columns and rows; otherwise leaves them scattered.
void arrange_as_grid(DisplacementField& field);

}  // namespace gladstone
