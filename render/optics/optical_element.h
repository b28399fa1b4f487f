#pragma once

#include "render/base/one_of.h"
#include "render/optics/aperture_stop.h"
#include "render/optics/thin_lens.h"

namespace gladstone {

/// Every element that a ray can meet between the scene and the sensor. An element has
/// `RayStatus interact(Ray<T>& ray, T& weight) const`: it moves a ray that runs towards +z to itself, turns it, and
/// takes its share of the light. Adding one: its struct, and its name here.
template <class T>
using OpticalElement = OneOf<ApertureStop<T>, ThinLens<T>>;

}  // namespace gladstone
