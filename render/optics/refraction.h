#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline optics {

/// Refracts a ray by Snell's law in vector form: n' d' - n d is parallel to the normal (Born & Wolf, Principles of
/// Optics, section 3.2.2).
/// @param direction  unit vector; replaced by the refracted direction, unchanged at total internal reflection
/// @param normal     unit vector of either sign
/// @param n_before   index on the side of incidence [1]
/// @param n_after    index on the other side [1]
/// @return false at total internal reflection
template <class T>
GLADSTONE_HD bool refract(Vec3<T>& direction, Vec3<T> const& normal, T const& n_before, T const& n_after) {
  using std::sqrt;
  T const ratio = n_before / n_after;
  T const cosine = dot(direction, normal);
  T const square = T(1) - ratio * ratio * (T(1) - cosine * cosine);
  if (square < T(0)) return false;
  T const cosine_after = cosine < T(0) ? -sqrt(square) : sqrt(square);
  direction = ratio * direction + (cosine_after - ratio * cosine) * normal;
  return true;
}

/// Reflects a ray direction. @param normal  unit vector of either sign
template <class T>
GLADSTONE_HD void reflect(Vec3<T>& direction, Vec3<T> const& normal) {
  direction = direction - T(2) * dot(direction, normal) * normal;
}

/// Returns the transmittance of an uncoated surface for unpolarised light: one minus the mean reflectance of the two
/// polarisations (Fresnel; Born & Wolf, section 1.5.2).
/// @param cosine_before,cosine_after  cosines of the angles to the normal on both sides, positive [1]
template <class T>
GLADSTONE_HD T fresnel_transmittance(T const& n_before, T const& n_after, T const& cosine_before,
                                     T const& cosine_after) {
  T const s = (n_before * cosine_before - n_after * cosine_after) / (n_before * cosine_before + n_after * cosine_after);
  T const p = (n_after * cosine_before - n_before * cosine_after) / (n_after * cosine_before + n_before * cosine_after);
  return T(1) - T(0.5) * (s * s + p * p);
}

}  // namespace gladstone::inline optics
