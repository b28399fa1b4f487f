#pragma once

#include <span>
#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline cases {

/// Returns the components of vectors one after another, as datasets of HDF5 files have them.
inline std::span<double const> flat(std::span<Vec2d const> values) {
  static_assert(sizeof(Vec2d) == 2 * sizeof(double));
  return {reinterpret_cast<double const*>(values.data()), 2 * values.size()};
}
inline std::span<double const> flat(std::vector<Vec2d> const& values) { return flat(std::span(values)); }
inline std::span<double const> flat(Image<Vec2d> const& image) {
  return flat(std::span<Vec2d const>(image.data(), image.size()));
}

}  // namespace gladstone::inline cases
