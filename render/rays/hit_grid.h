#pragma once

#include <cstdint>
#include <vector>

#include "render/rays/hit_spline.h"
#include "render/scene/light_image.h"

namespace gladstone {

/// Gathers the light of many rays with one Gaussian spot on the CPU, by a HitSpline. A ray costs sixteen additions
/// instead of a spot.
class HitGrid {
 public:
  explicit HitGrid(GaussianSpot<double> const& spot);

  /// Whether gathering so many rays pays, and their spot is wide enough for a grid of sensible size.
  static bool pays(double sigma, std::uint64_t rays);

  /// Adds a ray's light at p [px]; what lies beyond the grid first sends the grid to the image.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// Adds what has been gathered to the image (if any) and clears the grid.
  void flush(LightImage* image, double light_per_weight);

 private:
  static constexpr int side_px = 16;

  HitSpline spline_;
  HitSplineView view_;
  int side_;                               ///< nodes
  int left_ = 0, top_ = 0;                 ///< pixel of node (0, 0)
  NodeRange columns_{0, 0}, lines_{0, 0};  ///< touched part
  std::vector<double> light_, rows_seen_;
};

}  // namespace gladstone
