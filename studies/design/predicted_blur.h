#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/design/design_point.h"

namespace gladstone::inline design {

/// Closed-form prediction of the blur of a setup's field: displacement minus small-angle theory (Eq. 9) at points.
struct PredictedBlur {
  std::vector<Vec2d> cone_px;   ///< displacement averaged over light cone (F10) and dot [px]
  std::vector<Vec2d> whole_px;  ///< displacement averaged over the interrogation window (F11), too, with its squared
                                ///< weights [px]
};

/// Averages Eq. 9 on a lattice over the regions covered by cone, dot and window; equivalent to multiplying their
/// transfers, but applicable to any field. As in the formula, each slice of the field is weighted by its distance from
/// the dots, and all slices are assumed to be equal.
/// @param setup      setup of the view, which may be a part of the set-up's view about the axis
/// @param places_px  positions of the vectors, in pixels of that setup's camera
PredictedBlur predicted_blur(Setup const& setup, DesignPoint<double> const& bench, std::vector<Vec2d> const& places_px);

}  // namespace gladstone::inline design
