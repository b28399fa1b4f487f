#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "render/scene/scene.h"

/// How far independent scramblings of a scene's rays scatter: what planning the number of rays rests on.
namespace gladstone {

inline constexpr int plan_scramblings = 4;
inline constexpr std::size_t plan_sample_dots = 96;

/// What one scrambling of one dot gives: its displacement, NaN where no ray of it gets through, and its light in both
/// frames over a window.
struct Sampled {
  Vec2d displacement{};
  std::vector<double> light;
};

/// A square of pixels about a dot.
struct Window {
  int left, top, side;
};

/// Displacement of a dot over independent scramblings of its rays.
struct MeanDisplacement {
  Vec2d mean{};
  double variance = 0;  ///< between scramblings, averaged over both components [px^2]; NaN: none shows the dot

  /// @param found NaN where a scrambling does not show the dot, which counts as not moved where others do
  static MeanDisplacement of(Vec2d const (&found)[plan_scramblings]);
  double variance_of_mean() const { return variance / plan_scramblings; }
};
/// Over the dots that are shown; NaN where none is.
double mean_variance(std::vector<MeanDisplacement> const& displacements);

/// Scatter between scramblings at the scene's present number of rays.
struct Scatter {
  std::vector<MeanDisplacement> displacements;  ///< of the dots
  double light_variance = 0;                    ///< mean over lit pixels of the worse frame; NaN: none is lit
  double brightest = 0;                         ///< pixel of both frames, where dots overlap too
};

/// Bits of the grey levels that plans count in: the camera's, or 12 if that is coarser.
int plan_bits(CameraSetup const& camera);

/// What scatter of light is measured in: grey levels of the camera's depth, or of 12 bits if that is coarser.
struct GreyLevels {
  double density = 0;  ///< dots a pixel, placed at random
  double level =
      0;  ///< light of one level where a given exposure says so; 0: 90 % of full scale is the brightest pixel
  double at_peak = 0;  ///< levels of the brightest pixel
  int bits = 12;

  GreyLevels(CameraSetup const& camera, double dots_a_pixel);
  /// Root mean square over lit pixels of what light scatters by [levels]; NaN where none is lit.
  double error(Scatter const& scatter) const;
};

/// @param sample one scrambling of one dot; windows are of one size, the reference frame's light comes first
Scatter measure_scatter(std::vector<std::size_t> const& dots, GreyLevels const& levels,
                        std::function<Sampled(std::size_t dot, int scrambling)> const& sample);

/// The scene's dots in view; where there is none, the first.
std::vector<std::size_t> dots_in_view(Scene const& scene);

/// Spread evenly over the list: random dots are in random order, regular ones row by row.
std::vector<std::size_t> choose_sample(std::vector<std::size_t> const& dots, std::size_t count);

}  // namespace gladstone
