#pragma once

#include <algorithm>

#include "render/focused_dots/moment_images.h"
#include "render/focused_dots/one_lane.h"
#include "render/scene/light_patch.h"

namespace gladstone {

/// A patch that takes the light of narrow and wide dots, too.
class DotPatch : public LightPatch {
 public:
  /// @param images of the squares of displacement that it is to hold, or none
  DotPatch(SpotView const& spot, MomentImages const& images)
      : LightPatch(spot, images.half), of_square_(static_cast<std::size_t>(images.stride)) {}

  /// The image that light goes to from now on, or none.
  void begin(LightImage* image) { image_ = image; }
  static double units_per_weight() { return 1; }

  /// Adds a spot. @param fill (row, column, line) adds to a row's light from a column on
  template <int pixels, class Fill>
  void add(OneLane, Footprint const& spot, Fill const& fill) {
    double* const corner = reach(spot, image_, 1);
    for (int row = 0; row < spot.width; ++row) {
      double line[pixels] = {};
      fill(row, 0, line);
      for (int i = 0; i < spot.width; ++i) corner[row * side() + i] += line[i];
    }
  }
  /// Takes pixels of a square row by row, from `first` on, and adds it once it has the last of them.
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
  std::vector<double> of_square_;  ///< light of a square of displacement
};

}  // namespace gladstone
