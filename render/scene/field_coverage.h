#pragma once

#include <string>

#include "render/medium/field_volume.h"
#include "render/medium/index_sample.h"
#include "render/scene/setup.h"

namespace gladstone {

/// How much of the view a field fills, at the depth of its own middle.
struct FieldCoverage {
  Vec2d field{};     ///< width and height [m]; infinite where it has no end
  Vec2d view{};      ///< that chief rays cross there [m]
  double share = 0;  ///< of the view's area [1]
  double ratio = 0;  ///< the field's width or height over the view's, whichever is larger [1]

  /// A field that fills less than a tenth of the view, or reaches hundreds of times beyond it: what that looks like,
  /// and what it would be if lengths were told in another unit. Empty for others.
  std::string warning() const;
};

/// @param box where the field is [m]
FieldCoverage field_coverage(Bounds<double> const& box, Setup const& setup);

/// Warning if the view shows side faces of a file's field where n differs from the ambient by more than a fifth of its
/// range (rms over a face): rays that pass the field by see a jump there. Exchanged axes are a likely cause. Empty for
/// other fields.
std::string side_face_warning(BuiltMedium const& medium, Setup const& setup);

}  // namespace gladstone
