#pragma once

#include <cstdint>
#include <vector>

#include "render/rays/hit_spline.h"
#include "render/scene/light_image.h"

namespace gladstone {

/// Gathers the light of many rays with one Gaussian spot on the CPU, by a HitSpline. A ray costs sixteen additions
/// instead of a spot. The grid is made of square tiles, as many as the rays of a source reach.
class HitGrid {
 public:
  explicit HitGrid(GaussianSpot<double> const& spot);

  /// Whether gathering so many rays pays, and their spot is wide enough for a grid of sensible size.
  static bool pays(double sigma, std::uint64_t rays);

  /// Adds a ray's light at p [px]; a tile in whose place it needs another is sent to the image first.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// Adds what has been gathered to the image (if any) and clears the grid.
  void flush(LightImage* image, double light_per_weight);

 private:
  static constexpr int tile_px = 16, pad_px = 1;
  static constexpr int slots = 8;  ///< tiles along either axis that are held at a time

  struct Tile {
    Vec2<int> at{0, 0};                    ///< tiles from the first
    NodeRange columns{0, 0}, lines{0, 0};  ///< touched part
    std::vector<double> light;             ///< empty until it is needed

    bool touched() const { return columns.high > columns.low; }
  };
  void flush(Tile& tile, LightImage* image, double light_per_weight);

  HitSpline spline_;
  HitSplineView view_;
  int side_;           ///< of a tile [nodes]
  bool empty_ = true;  ///< nothing has been gathered
  Vec2<int> first_{};  ///< pixel of tile (0, 0), which has the first ray in its middle
  Tile tiles_[slots * slots];
  std::vector<double> rows_seen_;
};

}  // namespace gladstone
