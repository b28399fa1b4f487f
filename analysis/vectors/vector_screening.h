#pragma once

#include <cstddef>
#include <string>

#include "render/base/displacement_field.h"

namespace gladstone {

/// No window's centre lies beyond the image by more than this: codes that count from 1, or from a window's edge, differ
/// from us by 1.5 px at most.
inline constexpr double outside_margin_px = 2.0;

/// Vectors of a file that no camera can have seen, by reason.
struct LeftOutVectors {
  std::size_t place_not_finite = 0;
  std::size_t outside_image = 0;              ///< by more than outside_margin_px
  std::size_t displacement_not_finite = 0;    ///< though not masked in the file
  std::size_t displacement_beyond_image = 0;  ///< larger than the image is wide or high
  Vec2d low_px{}, high_px{};                  ///< of all finite places, as they stand in the file

  std::size_t without_place() const { return place_not_finite + outside_image; }
  std::size_t all() const { return without_place() + displacement_not_finite + displacement_beyond_image; }
  /// "3 with a place that is nan or infinite, 5 outside the image (by more than 2 px)"; empty where there is none.
  std::string text() const;
};

/// Takes vectors out whose places are not finite or lie outside the image, and marks those invalid whose displacement
/// is not finite or larger than the image, so that neither time nor memory nor any mean hangs on such numbers.
/// @param field     as it stands in a file, in any conventions: none of them leads out of the image
/// @param offset_px what is to be added to the file's coordinates, see VectorConventions
LeftOutVectors screen_vectors(DisplacementField& field, double offset_px, int image_columns, int image_rows);

/// Why screened vectors cannot be compared as a whole: most lie outside the image, their places lie closer than pixels,
/// or some are given twice. Empty where they can.
std::string refusal_of_places(DisplacementField const& screened, LeftOutVectors const& left_out, int image_columns,
                              int image_rows);

/// A doubt about places that crowd in a twentieth of the image; empty where they do not.
std::string doubt_about_places(DisplacementField const& screened, int image_columns, int image_rows);

}  // namespace gladstone
