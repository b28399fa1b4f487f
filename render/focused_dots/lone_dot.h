#pragma once

#include <memory>
#include <vector>

#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_integrator.h"
#include "render/focused_dots/owned_dot_model.h"
#include "render/scene/light_image.h"

namespace gladstone::inline focused_dots {

/// Difference of a sample of rays from the rendering of a lone dot: displacement [px] and light of a pixel window in
/// both images, the reference image first.
struct Difference {
  Vec2d displacement{};
  std::vector<double> light;
};

/// Sums over one sample of a lone dot's rays, in the order of a quasi-random sequence.
struct RaySample {
  struct Sum {
    Vec2d first{};
    double count = 0;
    Vec2d mean() const { return first / count; }
  };
  int rays = 0;           ///< number of rays whose landing the table has predicted
  Sum predicted;          ///< predicted landing positions of all rays [px]
  Sum also_predicted;     ///< predicted landing positions of the traced rays [px]
  Sum traced;             ///< landing positions of the traced rays [px]
  LightImage light;       ///< light of the predicted rays
  LightImage difference;  ///< light of the traced rays minus that of their predictions

  explicit RaySample(int side) : light(side, side), difference(side, side) {}
};

/// Rendering of a single white dot in pixel windows around its image in each frame, and its deviation from independent
/// samples of traced rays.
class LoneDot {
 public:
  LoneDot(LoneDot const&) = delete;  // dots_ points to dot_
  LoneDot& operator=(LoneDot const&) = delete;

  static constexpr int sample_count = 4;        ///< number of independent samples of rays
  static constexpr int largest_sample = 65536;  ///< maximum number of rays per sample whose landing the table predicts
  static constexpr int predicted_per_traced = 8;  ///< number of predicted rays per traced ray

  /// @param all    scene and plan, which must outlive this; its dots are replaced
  /// @param place  position on the target [m]
  /// @param side   side of the windows [px]
  LoneDot(FocusedDots const& all, Vec2d place, int side);

  /// Returns true if the table does not cover the dot.
  bool is_uncovered() const { return seen_.kind == DotKind::left; }
  /// Adds rays to the samples until each has the given number, and updates their differences.
  void compare_with_rays(int rays);
  /// Returns the light of the rendering in the pixel windows of both images, the reference image first.
  std::vector<double> const& light() const { return light_; }
  /// Returns the difference between the rays of sample k and the rendering.
  Difference const& difference(int k) const { return difference_[k]; }

 private:
  /// Renders the dot again in a window centred at the given distance from its undisplaced image, with pixels counted
  /// from the window's corner, and stores the light of one frame.
  void render_frame(std::size_t frame, Vec2d moved);
  /// Adds rays to a sample. Many rays land as the table predicts, and some of them are also traced to correct the
  /// prediction (control variate).
  template <class Medium>
  void add_rays(Medium const& medium, std::size_t scrambling, int rays, RaySample& sample);

  DotPattern dot_;                  ///< the dot, alone
  FocusedDots dots_;                ///< scene and plan of all dots, with this one in place of the others
  int side_;                        ///< side of the pixel windows [px]
  std::vector<RaySample> samples_;  ///< independent samples of rays; none for a dot that the medium does not move
  std::unique_ptr<DeflectionMap> table_;
  std::unique_ptr<OwnedDotModel> owned_;
  std::unique_ptr<DotIntegrator> integrator_;
  DotAim aim_;
  RenderedDot seen_;
  std::vector<double> light_;
  Difference difference_[sample_count];
};

}  // namespace gladstone::inline focused_dots
