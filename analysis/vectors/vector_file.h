#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/displacement_field.h"
#include "render/base/hdf5_file.h"

namespace gladstone {

/// How the numbers of a vector file relate to ours (column right and row down from 0 at the first pixel's centre,
/// displacement = flow minus reference, v down). Columns first: exchanged. Then positions, in the file's own axes:
/// x = x_file/px + offset, y' = y_file/px + offset, y = mirror - y' if y_up; displacements: u = u_file/px_per_frame,
/// v = -v_file/px_per_frame if v_up, then both change sign if swapped.
struct VectorConventions {
  enum class Mirror {
    grid,   ///< about the middle of the vector grid: y' min + y' max (OpenPIV's transform_coordinates)
    image,  ///< about the middle of the image: rows - 1
  };
  /// Which pairs of columns stand in each other's place.
  enum class Exchange { none, places, components, axes };  ///< x and y, u and v, both

  bool y_up = false;       ///< y grows upwards
  bool v_up = false;       ///< v counts upwards
  bool swapped = false;    ///< reference minus flow: the frames were exchanged
  double offset_px = 0.0;  ///< ours minus the file's coordinates; -0.5 for codes that report x = ws/2, -1 for 1-based
  Mirror mirror = Mirror::grid;
  Exchange exchange = Exchange::none;
  std::optional<double> px{};            ///< a pixel, in the unit of the file's places
  std::optional<double> px_per_frame{};  ///< a displacement of a pixel, in the unit of the file's displacements

  bool exchanges_places() const { return exchange == Exchange::places || exchange == Exchange::axes; }
  bool exchanges_components() const { return exchange == Exchange::components || exchange == Exchange::axes; }

  friend bool operator==(VectorConventions const&, VectorConventions const&) = default;
};

/// As the user tells it: words separated by commas out of y-down, y-up (about the grid), y-up-image, v-down, v-up,
/// frames-exchanged (or swapped), axes-exchanged, places-exchanged, components-exchanged, offset=NUMBER, px=NUMBER,
/// px/frame=NUMBER; what is left unsaid is as in `from`. @throws std::invalid_argument naming the word
VectorConventions parse_conventions(std::string_view text, VectorConventions from = {});
/// The same words, complete: "y-up,v-up,offset=-0.5".
std::string describe(VectorConventions const& conventions);

/// Vectors as they stand in a file.
struct VectorFile {
  DisplacementField field;  ///< numbers as written
  std::string format;       ///< "gladstone", "OpenPIV", "PIVlab", "DaVis", "Insight", "JPIV", "named columns", ...
  VectorConventions conventions;          ///< what the format's own program writes by default
  bool foreign = true;                    ///< false: ours
  std::vector<VectorConventions> also{};  ///< what it writes as well
  std::string place_unit{};               ///< as the file states it; empty: px
  std::string displacement_unit{};        ///< likewise
  std::vector<std::string> warnings{};    ///< of what was assumed or not read
};

/// Reads vectors.h5 or vectors.csv of ours, and text of OpenPIV, PIVlab, DaVis, TSI Insight, Dantec and JPIV; any text
/// with a header line of columns x, y, u, v (or vx, vy), with or without units. Separators: comma, semicolon, tab or
/// blanks; decimals may have commas. A complete lattice of vectors is put in our order (row by row from
/// the smallest y) and `columns`, `rows` are set.
/// @throws DataError with file:line for what cannot be read
VectorFile read_vectors(std::string const& path);

/// Whether words of conventions say how to read a file's axes, signs or places, not just how much a pixel is.
bool specifies_reading(std::string_view text);
/// Puts the words of parse_conventions() over what the format's program writes.
void override_conventions(VectorFile& file, std::string_view text);

/// The same file with places and displacements in px, by its conventions' px and px_per_frame.
/// @throws DataError where the file states other units and the conventions do not say what a pixel is in them
VectorFile convert_to_pixels(VectorFile file, std::string const& path);

/// Vectors in our conventions; grids come back in our order. @pre they are in px
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
