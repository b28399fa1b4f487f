#pragma once

#include <vector>

#include "render/base/vec.h"
#include "render/scene/light_image.h"
#include "render/scene/spot.h"

namespace gladstone {

/// A square piece of a frame in which one source's rays are gathered in double before they join the image.
class LightPatch {
 public:
  /// @param half pixels to each side that it is to have room for, should the spot's be fewer
  explicit LightPatch(SpotView const& spot, int half = 0);

  /// Adds one ray's spot of weight `weight` at p [px]; a spot beyond the patch first sends the patch to the image.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// Adds what has been gathered to the image (if any) and clears the patch.
  void flush(LightImage* image, double light_per_weight);

 protected:
  SpotView const& spot() const { return spot_; }
  /// Pixels that a spot reaches to each side of its own.
  int half() const { return half_; }
  /// From one row of the patch to the next.
  int side() const { return side_; }
  /// Makes room for a spot and marks it as touched. @return the place of its first pixel
  double* reach(Footprint const& spot, LightImage* image, double light_per_weight);

 private:
  SpotView spot_;
  int half_;
  int side_;
  int left_ = 0, top_ = 0;                                             // image position of the patch's corner
  int low_column_ = 0, high_column_ = 0, low_row_ = 0, high_row_ = 0;  // touched part
  std::vector<double> light_;
  std::vector<double> column_shares_, row_shares_;  ///< for shares()
};

}  // namespace gladstone
