#pragma once

#include <span>

#include "analysis/correlation/bspline_image.h"

namespace gladstone {

/// A row of a deformed pair, where it is written.
struct DeformedRow {
  float* reference;
  float* flow;
  float* available;
};

/// What deformed_pixel() does, eight pixels of a row at a time: neighbours are mostly moved by the same whole pixels,
/// and then read the same coefficients, one beside the other.
struct LaneDeformation {
  BsplineView<float> reference;
  BsplineView<float> flow;
  std::span<float const> available;  ///< 1 where both images are known, 0 elsewhere; empty: everywhere

  /// @param degree of the splines, 3 or 5, or windowed_sinc
  /// @param u, v   displacement of every pixel of row j [px]
  void row(int degree, int j, std::span<float const> u, std::span<float const> v, DeformedRow const& out) const;
};

}  // namespace gladstone
