#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/design/bench.h"

namespace gladstone {

/// What the closed forms' blur makes of the very field that a setup has, as displacements less Eq. 9 at single places.
struct PredictedBlur {
  std::vector<Vec2d> cone_px;   ///< cone of light (F10) and dot
  std::vector<Vec2d> whole_px;  ///< and the window (F11), as its squared weights
};

/// Eq. 9 on a lattice of the view, averaged over where cone, dot and window reach: the product of their transfers, for
/// any field. A slice of the field counts by its distance from the dots, and all slices are taken for alike, as the
/// formula has it.
/// @param setup that is seen; it may be a part of the bench's view about the axis
/// @param places_px of vectors, in pixels of that setup's camera
PredictedBlur predicted_blur(Setup const& setup, Bench<double> const& bench, std::vector<Vec2d> const& places_px);

}  // namespace gladstone
