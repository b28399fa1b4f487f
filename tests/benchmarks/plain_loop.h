#pragma once

#include "render/light/sources.h"
#include "render/medium/medium.h"

namespace gladstone::bench {

/// What a plain programmer writes: one ray at a time, 64 terms in a triple loop for the value and the three
/// derivatives, Sharma's RK4 and nothing else. The yardstick for the renderer's steps per second.
struct PlainRay {
  Vec3d position;   ///< [m]
  Vec3d direction;  ///< optical, n dR/ds [1]
};

/// Takes a ray `steps` steps of dt = step/n further.
PlainRay plain_steps(SplineVolume<double> const& volume, Ray<double> const& start, double step, int steps);

}  // namespace gladstone::bench
