#include "render/scene/source_cubature.h"

#include <algorithm>
#include <cmath>

#include "render/base/gauss_legendre.h"
#include "render/base/units.h"

namespace gladstone::inline scene {

SourceCubature SourceCubature::disc(int radial, int innermost, int outermost) {
  SourceCubature cubature;
  GaussLegendre const nodes(radial);
  for (int i = 0; i < radial; ++i) {
    double const r = std::sqrt(0.5 * (1 + nodes.node[static_cast<std::size_t>(i)]));
    int const angular = static_cast<int>(std::ceil(innermost + (outermost - innermost) * r));
    for (int k = 0; k < angular; ++k) {
      double const angle = 2 * pi * (k + 0.5 * (i % 2)) / angular;
      cubature.points.push_back({r * std::cos(angle), r * std::sin(angle)});
      cubature.weights.push_back(0.5 * nodes.weight[static_cast<std::size_t>(i)] / angular);
    }
  }
  return cubature;
}

SourceCubature SourceCubature::radon() {
  SourceCubature cubature{{{0, 0}}, {0.25}};
  for (int k = 0; k < 6; ++k) {
    double const angle = pi * k / 3;
    cubature.points.push_back({std::sqrt(2.0 / 3.0) * std::cos(angle), std::sqrt(2.0 / 3.0) * std::sin(angle)});
    cubature.weights.push_back(0.125);
  }
  return cubature;
}

SourceCubature SourceCubature::make(SourceShape shape, double half_size_px, double spot_px) {
  if (half_size_px == 0) return {{{0, 0}}, {1.0}};
  // The outline of the source is blurred by the PSF, the shortest length scale.
  double const fineness = half_size_px / std::clamp(spot_px, 0.05, 2.0);
  if (shape == SourceShape::disc) {
    return disc(std::clamp(static_cast<int>(std::ceil(fineness)) + 2, 3, 64), 6,
                std::clamp(static_cast<int>(std::ceil(4 * fineness)) + 6, 9, 256));
  }
  return square(2 * std::clamp(static_cast<int>(std::ceil(1.5 * fineness)) + 3, 4, 64));
}

SourceCubature SourceCubature::square(int side) {
  SourceCubature cubature;
  GaussLegendre const nodes(side);
  for (std::size_t i = 0; i < nodes.node.size(); ++i) {
    for (std::size_t k = 0; k < nodes.node.size(); ++k) {
      cubature.points.push_back({nodes.node[i], nodes.node[k]});
      cubature.weights.push_back(0.25 * nodes.weight[i] * nodes.weight[k]);
    }
  }
  return cubature;
}

}  // namespace gladstone::inline scene
