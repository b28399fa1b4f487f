#pragma once

#include <type_traits>

#include "render/medium/medium.h"

/// Conversion of views to another scalar type, for the preview in single precision; one overload per medium.
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
/// Converts a medium in closed form.
template <class T, class Form>
requires std::is_base_of_v<Slab<double>, Form>
auto cast(Form const& form) { return form.template in_scalar<T>(); }

/// Converts a grid's view. @param coefficients  copy of the coefficients, possibly of another type
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
