#pragma once

#include <vector>

#include "render/base/vec.h"
#include "render/scene/light_image.h"
#include "render/scene/spot.h"

namespace gladstone::inline scene {

/// Square pixel buffer that accumulates the PSFs of one source's rays in double precision before they are added to the
/// image.
class LightPatch {
 public:
  /// @param half  minimum half width of the footprints that the buffer must hold, if larger than that of the PSF [px]
  explicit LightPatch(SpotView const& spot, int half = 0);

  /// Adds the PSF of one ray with the given weight at p [px]. If it does not fit into the buffer, the buffer is flushed
  /// first.
  void deposit(Vec2d p, double weight, LightImage* image, double light_per_weight);
  /// Adds the buffer to the image (unless null) and clears it.
  void flush(LightImage* image, double light_per_weight);

 protected:
  /// Row length of the buffer [px].
  int side() const { return side_; }
  /// Makes room for a footprint and marks its pixels as used.
  /// @return pointer to its first pixel
  double* reach(Footprint const& spot, LightImage* image, double light_per_weight);

 private:
  SpotView spot_;
  int half_;
  int side_;
  int left_ = 0, top_ = 0;                                             // image position of the buffer's first pixel
  int low_column_ = 0, high_column_ = 0, low_row_ = 0, high_row_ = 0;  // range of used pixels
  std::vector<double> light_;
  std::vector<double> column_shares_, row_shares_;  ///< factors of the PSF along both axes
};

}  // namespace gladstone::inline scene
