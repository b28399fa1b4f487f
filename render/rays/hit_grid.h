#pragma once

#include <cstdint>
#include <vector>

#include "render/rays/hit_spline.h"
#include "render/scene/light_image.h"

namespace gladstone::inline rays {

/// Accumulates the light of many rays with the same Gaussian PSF on the CPU by a HitSpline. A ray costs sixteen
/// additions instead of the evaluation of a PSF. The grid consists of square tiles that are allocated where rays land.
class HitGrid {
 public:
  explicit HitGrid(GaussianSpot<double> const& spot);

  /// Returns true if the grid is faster than individual PSFs for the given number of rays and the PSF is wide enough
  /// for a grid of moderate size.
  static bool is_faster_than_psfs(double sigma, std::uint64_t rays);

  /// Adds the light of a ray at p [px]. A tile that occupies the slot of the required one is first added to the image.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// Adds all tiles to the image (unless null) and clears them.
  void flush(LightImage* image, double light_per_weight);

 private:
  static constexpr int tile_px = 16, pad_px = 1;
  static constexpr int slots = 8;  ///< number of tiles along either axis that are stored at a time

  struct Tile {
    Vec2<int> at{0, 0};                    ///< position in tiles relative to the first tile
    NodeRange columns{0, 0}, lines{0, 0};  ///< range of used nodes
    std::vector<double> light;             ///< light at the nodes; empty until first used

    bool touched() const { return columns.high > columns.low; }
  };
  void flush(Tile& tile, LightImage* image, double light_per_weight);

  HitSpline spline_;
  HitSplineView view_;
  int side_;           ///< nodes along a tile's side
  bool empty_ = true;  ///< true: no light has been added
  Vec2<int> first_{};  ///< pixel of tile (0, 0), which is centred on the first ray
  Tile tiles_[slots * slots];
  std::vector<double> rows_seen_;
};

}  // namespace gladstone::inline rays
