#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::tracking {

/// Radial profile of the round dot images of a frame: a sum of concentric Gaussians whose variances are fixed fractions
/// of the variance of the dot (multi-Gaussian expansion: Emsellem, Monnet & Bacon, Astron. Astrophys. 285 (1994) 723).
/// It represents images of discs: for a disc of 3 px, blurred by diffraction at f/11, the rms deviation is 0.1 % of the
/// peak, where that of one Gaussian is 4 %. Each Gaussian is integrated over the pixels, so that the profile cannot
/// follow errors of the centres that depend on the pixel phase.
struct DotProfile {
  static constexpr std::size_t count = 5;
  /// Variances of the Gaussians over that of the dot [1].
  static constexpr std::array<double, count> scale{0.25, 0.35, 0.5, 0.7, 1.0};
  std::array<double, count> share{0, 0, 0, 0, 1};  ///< fraction of the dot's light in each Gaussian [1]

  bool gaussian() const { return share == DotProfile{}.share; }
};

/// Pixel near a dot that was fitted alone.
struct ProfileSample {
  double level = 0;                                  ///< light of the dot over its flux [1]
  double weight = 0;                                 ///< reciprocal variance of `level` [1]
  std::array<double, DotProfile::count> gaussian{};  ///< light of each Gaussian of the profile, with a flux of 1 [1]
  Vec2d by_centre{};                                 ///< derivatives of the level with respect to the centre [1/px]
};

/// Profile fitted to dots.
struct FittedProfile {
  DotProfile profile;
  double flux_factor = 1;  ///< flux with this profile over the flux with that of the samples [1]
};

/// Fits the profile of the dots of a frame by weighted least squares, together with the background and a small shift of
/// each dot. Dots with an unusual residual, such as two dots that were fitted as one, are excluded.
/// @param dots  pixels of each dot
/// @return a Gaussian unless its misfit is above 0.5 % of the light and other profiles fit significantly better: F
/// ratio
///         of five coefficients to one above 6, which noise exceeds with a probability of 1e-4
FittedProfile fit_dot_profile(std::span<std::vector<ProfileSample> const> dots);

}  // namespace gladstone::tracking
