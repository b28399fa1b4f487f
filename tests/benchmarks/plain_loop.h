#pragma once

#include "render/light/sources.h"
#include "render/medium/medium.h"

namespace gladstone::bench {

/// Plain implementation to which the renderer's steps per second are compared: one ray at a time, 64 terms in a triple
/// loop for the value and the three derivatives, and Sharma's RK4.
struct PlainRay {
  Vec3d position;   ///< [m]
  Vec3d direction;  ///< optical, n dR/ds [1]
};

/// Takes a ray `steps` steps of dt = step/n further.
PlainRay plain_steps(SplineVolume<double> const& volume, Ray<double> const& start, double step, int steps);

}  // namespace gladstone::bench
