#pragma once

#include <optional>
#include <string>

#include "render/base/warning.h"
#include "render/medium/field_volume.h"
#include "render/medium/index_sample.h"
#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Extent of a density field compared with the field of view, at the depth of the field's mid-plane.
struct FieldCoverage {
  Vec2d field{};     ///< width and height of the field [m]; infinite if unbounded
  Vec2d view{};      ///< width and height of the view at the depth of the field's mid-plane [m]
  double share = 0;  ///< fraction of the view's area that the field covers [1]
  double ratio = 0;  ///< width or height of the field relative to the view, the larger ratio [1]

  /// Returns a warning if the field covers less than a tenth of the view or is more than 300 times wider, as happens if
  /// lengths are given in the wrong unit. The warning states the sizes and the size in another
  /// unit.
  std::optional<Warning> warning() const;
};

/// Computes the coverage of the view by a field.
/// @param box  bounds of the field [m]
FieldCoverage field_coverage(Bounds<double> const& box, Setup const& setup);

/// Returns a warning if the view shows side faces of a field read from a file at which n differs markedly from the
/// ambient index: by more than a fifth of the field's range (rms over a face). Rays that miss the field see a jump
/// there; swapped axes are a likely cause.
std::optional<Warning> side_face_warning(BuiltMedium const& medium, Setup const& setup);

}  // namespace gladstone::inline scene
