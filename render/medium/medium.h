#pragma once

#include <variant>

#include "render/medium/analytic_fields.h"
#include "render/medium/refractive_index_volume.h"

namespace gladstone {

template <class T>
using SplinePlane = GriddedIndex<T, double, CubicBspline, 2>;
template <class T>
using SplineVolume = GriddedIndex<T, float, CubicBspline, 3>;
template <class T>
using LinearPlane = GriddedIndex<T, double, Linear, 2>;
template <class T>
using LinearVolume = GriddedIndex<T, float, Linear, 3>;

/// Every medium that a ray can cross, as views; the closed set from which launchers choose once per launch.
/// A medium has bounds() [m] and sample(p) -> IndexSample. Adding one: its struct, and its name here.
template <class T>
using Medium = std::variant<NoMedium<T>, UniformGradient<T>, Sinusoid<T>, GaussianPlume<T>, GaussianBlob<T>,
                            NormalShock<T>, SplinePlane<T>, SplineVolume<T>, LinearPlane<T>, LinearVolume<T>>;

}  // namespace gladstone
