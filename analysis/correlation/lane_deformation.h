#pragma once

#include <span>

#include "analysis/correlation/bspline_image.h"

namespace gladstone::inline correlation {

/// Output row of a deformed pair.
struct DeformedRow {
  float* reference;
  float* flow;
  float* available;
};

/// SIMD version of deformed_pixel(), for eight pixels of a row at a time. Neighbouring pixels mostly share the same
/// integer displacement and therefore read adjacent coefficients.
struct LaneDeformation {
  BsplineView<float> reference;
  BsplineView<float> flow;
  /// 1 at pixels that are known in both images, otherwise 0; empty: all pixels are known.
  std::span<float const> available;

  /// Deforms row j of both images.
  /// @param degree  degree of the splines, 3 or 5, or windowed_sinc
  /// @param u,  v components of the displacement of every pixel of the row [px]
  void row(int degree, int j, std::span<float const> u, std::span<float const> v, DeformedRow const& out) const;
};

}  // namespace gladstone::inline correlation
