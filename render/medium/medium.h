#pragma once

#include <variant>

#include "render/medium/closed_forms.h"
#include "render/medium/refractive_index_volume.h"

namespace gladstone::inline medium {

template <class T>
using SplinePlane = GriddedIndex<T, double, CubicBspline, 2>;
template <class T>
using SplineVolume = GriddedIndex<T, float, CubicBspline, 3>;
template <class T>
using LinearPlane = GriddedIndex<T, double, Linear, 2>;
template <class T>
using LinearVolume = GriddedIndex<T, float, Linear, 3>;

namespace detail {

template <class T, class Forms>
struct MediumOf;
template <class T, class... Forms>
struct MediumOf<T, std::variant<Forms...>> {
  using Type = std::variant<NoMedium<T>, Forms..., SplinePlane<T>, SplineVolume<T>, LinearPlane<T>, LinearVolume<T>>;
};

}  // namespace detail

/// Closed set of all media, as views: none, closed forms, and gridded fields. Launchers select the type once per
/// launch. A medium has bounds() [m] and sample(p) -> IndexSample.
template <class T>
using Medium = typename detail::MediumOf<T, ClosedForm<T>>::Type;

}  // namespace gladstone::inline medium
