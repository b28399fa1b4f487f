#pragma once

#include "render/base/one_of.h"
#include "render/optics/aperture_stop.h"
#include "render/optics/thin_lens.h"

namespace gladstone {

/// Closed set of all elements of an OpticalTrain. An element has `RayStatus interact(Ray<T>& ray, T& weight) const`,
/// which moves a ray that travels in +z direction to the element, deflects it and multiplies its weight by the
/// transmission. To add one, write its struct and add its name here.
template <class T>
using OpticalElement = OneOf<ApertureStop<T>, ThinLens<T>>;

}  // namespace gladstone
