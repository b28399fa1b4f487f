#pragma once

#include <algorithm>

#include "render/focused_dots/moment_images.h"
#include "render/focused_dots/one_lane.h"
#include "render/scene/light_patch.h"

namespace gladstone::inline focused_dots {

/// Pixel buffer that also accumulates the light of narrow and wide dots.
class DotPatch : public LightPatch {
 public:
  /// @param images  moment images, which determine the minimum size of the buffer; may be empty
  DotPatch(SpotView const& spot, MomentImages const& images)
      : LightPatch(spot, images.half), of_square_(static_cast<std::size_t>(images.stride)) {}

  /// Sets the image to which the light is added from now on, or null.
  void begin(LightImage* image) { image_ = image; }
  static double units_per_weight() { return 1; }

  /// Adds the footprint of a PSF.
  /// @param fill  (row, column, line) adds the light of a row, from a column on, to `line`
  template <int pixels, class Fill>
  void add(OneLane, Footprint const& spot, Fill const& fill) {
    double* const corner = reach(spot, image_, 1);
    for (int row = 0; row < spot.width; ++row) {
      double line[pixels] = {};
      fill(row, 0, line);
      for (int i = 0; i < spot.width; ++i) corner[row * side() + i] += line[i];
    }
  }
  /// Receives the pixels of a square's image in row order, starting with `first`, and adds the image when the last
  /// pixel has been received.
  template <int pixels>
  void add_run(Footprint const& square, int first, double const (&light)[pixels]) {
    std::copy_n(light, pixels, of_square_.data() + first);
    int const width = square.width;
    if (first + pixels < width * width) return;
    double* const corner = reach(square, image_, 1);
    for (int row = 0; row < width; ++row) {
      double const* const line = of_square_.data() + row * width;
      for (int column = 0; column < width; ++column) corner[row * side() + column] += line[column];
    }
  }

 private:
  LightImage* image_ = nullptr;
  std::vector<double> of_square_;  ///< light of the displacements in one square
};

}  // namespace gladstone::inline focused_dots
