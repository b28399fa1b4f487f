#pragma once

#include <cstddef>
#include <string>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline vectors {

/// Tolerance for window centres outside of the image. Software that counts pixels from 1, or from a window's edge,
/// differs from our conventions by at most 1.5 px.
inline constexpr double outside_margin_px = 2.0;

/// Numbers of implausible vectors of a file, one for each reason.
struct RejectedVectors {
  std::size_t place_not_finite = 0;
  std::size_t outside_image = 0;              ///< outside of the image by more than outside_margin_px
  std::size_t displacement_not_finite = 0;    ///< displacement not finite, unless the vector is masked in the file
  std::size_t displacement_beyond_image = 0;  ///< displacement larger than the image's width or height
  Vec2d low_px{}, high_px{};                  ///< range of all finite positions, in the file's coordinates

  std::size_t without_place() const { return place_not_finite + outside_image; }
  std::size_t all() const { return without_place() + displacement_not_finite + displacement_beyond_image; }
  /// Returns a list of the counts, such as "3 with a position that is nan or infinite, 5 outside the image (by more
  /// than 2 px)"; empty if all counts are 0.
  std::string text() const;
};

/// Removes vectors whose positions are not finite or outside of the image, and marks vectors invalid whose displacement
/// is not finite or larger than the image. This bounds run time, memory and averages for arbitrary input.
/// @param field      vectors in the file's conventions; the image's range is the same in all of them
/// @param offset_px  offset to be added to the file's coordinates, see VectorConventions
RejectedVectors screen_vectors(DisplacementField& field, double offset_px, int image_columns, int image_rows);

/// Returns the reason why screened vectors cannot be compared at all: most are outside of the image, there are more
/// than two per pixel, or some positions occur twice. Returns an empty string if the vectors can be compared.
std::string reason_to_reject_positions(DisplacementField const& screened, RejectedVectors const& left_out,
                                       int image_columns, int image_rows);

/// Returns a warning if at least 16 vectors cover less than a twentieth of the image's area, else an empty string.
std::string describe_suspect_positions(DisplacementField const& screened, int image_columns, int image_rows);

}  // namespace gladstone::inline vectors
