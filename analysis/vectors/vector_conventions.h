#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "analysis/vectors/displacement_field.h"

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
/// @throws DataError for an invalid word, which the message contains
VectorConventions parse_conventions(std::string_view text, VectorConventions from = {});

/// Returns all conventions in the words of parse_conventions(), for example "y-up,v-up,offset=-0.5".
std::string describe(VectorConventions const& conventions);

/// Returns true if the words specify axes, signs or positions rather than only the size of a pixel.
bool specifies_reading(std::string_view text);

/// Converts vectors to our conventions; vectors on a complete lattice are sorted in our order.
/// @pre the vectors are in px
/// @param image_rows  number of rows of the image, for Mirror::image
DisplacementField apply_conventions(DisplacementField field, VectorConventions const& conventions, int image_rows);

}  // namespace gladstone::inline vectors
