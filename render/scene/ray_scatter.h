#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "render/scene/scene.h"

/// Scatter between independent scramblings of a scene's rays, from which the number of rays is planned.
namespace gladstone {

/// Number of independent scramblings of the rays of each sampled source.
inline constexpr int budget_scramblings = 4;
/// Maximum number of sampled sources.
inline constexpr std::size_t plan_sample_dots = 96;

/// Result of one scrambling of one dot's rays: the displacement [px], NaN if no ray passes, and the light of a pixel
/// window in both images, the reference image first.
struct Sampled {
  Vec2d displacement{};
  std::vector<double> light;
};

/// Mean and variance of a dot's displacement over independent scramblings of its rays.
struct MeanDisplacement {
  Vec2d mean{};
  double variance = 0;  ///< mean of both components, between scramblings [px^2]; NaN: dot not visible

  /// @param found  displacements [px]; NaN if the scrambling does not show the dot, which counts as zero displacement
  ///   if another scrambling does
  static MeanDisplacement of(Vec2d const (&found)[budget_scramblings]);
};
/// Returns the mean variance of the dots that are visible [px^2]; NaN if none is.
double mean_variance(std::vector<MeanDisplacement> const& displacements);

/// Scatter between scramblings at the scene's current number of rays.
struct Scatter {
  std::vector<MeanDisplacement> displacements;  ///< displacement statistics of each dot
  double light_variance = 0;  ///< variance of the light, mean over lit pixels of the worse image; NaN: none is lit
  double brightest = 0;       ///< light of the brightest pixel of both images, including overlapping dots
};

/// Returns the bit depth in which errors are measured: the camera's, 12 at most.
int error_bit_depth(CameraSetup const& camera);

/// Unit of image errors: grey levels at the camera's bit depth, 12 bits at most.
struct GreyLevels {
  double density = 0;  ///< number of randomly placed dots per pixel [1/px^2]
  double level = 0;    ///< light of one grey level for a given exposure; 0: auto exposure
  double at_peak = 0;  ///< grey levels of the brightest pixel for auto exposure
  int bits = 12;

  GreyLevels(CameraSetup const& camera, double dots_per_pixel);
  /// Returns the rms scatter of the light over lit pixels [grey levels]; NaN if no pixel is lit.
  double error(Scatter const& scatter) const;
};

/// Measures the scatter between scramblings of the rays of some dots.
/// @param sample  renders one scrambling of one dot; all pixel windows have the same size
Scatter measure_scatter(std::vector<std::size_t> const& dots, GreyLevels const& levels,
                        std::function<Sampled(std::size_t dot, int scrambling)> const& sample);

/// Returns the indices of the scene's sources in view; if none is in view, that of the first source.
std::vector<std::size_t> dots_in_view(Scene const& scene);

/// Selects `count` dots spread evenly over the list. Random dots are in random order, regular ones row by row.
std::vector<std::size_t> choose_sample(std::vector<std::size_t> const& dots, std::size_t count);

}  // namespace gladstone
