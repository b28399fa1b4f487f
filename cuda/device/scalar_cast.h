#pragma once

#include <type_traits>

#include "render/medium/medium.h"

/// Views in another scalar: what the single-precision preview traces. One function for every medium.
namespace gladstone::cuda {

template <class T>
Vec2<T> cast(Vec2<double> v) {
  return {static_cast<T>(v.x), static_cast<T>(v.y)};
}
template <class T>
Vec3<T> cast(Vec3<double> v) {
  return {static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)};
}

template <class T>
NoMedium<T> cast(NoMedium<double> const&) {
  return {};
}
template <class T>
Slab<T> cast_slab(Slab<double> const& slab) {
  return {static_cast<T>(slab.half_thickness), static_cast<T>(slab.gladstone_dale),
          static_cast<T>(slab.ambient_density)};
}
template <class T>
UniformGradient<T> cast(UniformGradient<double> const& m) {
  return {cast_slab<T>(m), cast<T>(m.gradient)};
}
template <class T>
Sinusoid<T> cast(Sinusoid<double> const& m) {
  return {cast_slab<T>(m), static_cast<T>(m.amplitude), cast<T>(m.wavevector), static_cast<T>(m.phase)};
}
template <class T>
GaussianPlume<T> cast(GaussianPlume<double> const& m) {
  return {cast_slab<T>(m), static_cast<T>(m.amplitude), static_cast<T>(m.radius)};
}
template <class T>
GaussianBlob<T> cast(GaussianBlob<double> const& m) {
  return {cast_slab<T>(m), static_cast<T>(m.amplitude), static_cast<T>(m.radius)};
}
template <class T>
NormalShock<T> cast(NormalShock<double> const& m) {
  return {cast_slab<T>(m),
          static_cast<T>(m.upstream),
          static_cast<T>(m.jump),
          static_cast<T>(m.thickness),
          static_cast<T>(m.position),
          static_cast<T>(m.normal_x),
          static_cast<T>(m.normal_z)};
}

/// A grid's view with coefficients that lie elsewhere, perhaps in another type.
template <class T, class Stored, class From, class Basis, int Dimensions>
GriddedIndex<T, Stored, Basis, Dimensions> cast_grid(GriddedIndex<double, From, Basis, Dimensions> const& m,
                                                     Stored const* coefficients) {
  GriddedIndex<T, Stored, Basis, Dimensions> other;
  other.coefficients = coefficients;
  other.row = m.row;
  other.plane = m.plane;
  other.nodes = m.nodes;
  other.periodic = m.periodic;
  other.origin = cast<T>(m.origin);
  other.inverse_spacing = cast<T>(m.inverse_spacing);
  other.offset = static_cast<T>(m.offset);
  other.box = {cast<T>(m.box.low), cast<T>(m.box.high)};
  return other;
}

}  // namespace gladstone::cuda
