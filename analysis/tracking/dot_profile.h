#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone::inline tracking {

/// Radial profile of the round dot images of a frame: a sum of concentric Gaussians whose variances are fixed fractions
/// of the variance of the dot (multi-Gaussian expansion: Emsellem, Monnet & Bacon, Astron. Astrophys. 285 (1994) 723).
/// The profile can represent images of discs: for a disc of 3 px, blurred by diffraction at f/11, its rms deviation is
/// 0.1 % of the peak, whereas that of one Gaussian is 4 %. Each Gaussian is integrated over the pixels, so that a wrong
/// profile cannot compensate errors of the centres that depend on the position of the dot relative to the pixels.
struct DotProfile {
  static constexpr std::size_t count = 5;
  /// Ratios of the Gaussians' variances to that of the dot [1].
  static constexpr std::array<double, count> scale{0.25, 0.35, 0.5, 0.7, 1.0};
  std::array<double, count> share{0, 0, 0, 0, 1};  ///< fraction of the dot's light in each Gaussian [1]

  bool gaussian() const { return share == DotProfile{}.share; }
};

/// Pixel near a dot that was fitted individually.
struct ProfileSample {
  /// Light of the dot on the pixel divided by the flux of the dot [1].
  double level = 0;
  double weight = 0;                                 ///< reciprocal variance of `level` [1]
  std::array<double, DotProfile::count> gaussian{};  ///< light of each Gaussian of the profile, with a flux of 1 [1]
  Vec2d by_centre{};                                 ///< derivatives of the level with respect to the centre [1/px]
};

/// Profile fitted to dots.
struct FittedProfile {
  DotProfile profile;
  /// Ratio of a dot's flux fitted with this profile to its flux fitted with the previous profile [1].
  double flux_factor = 1;
};

/// Fits the profile of the dots of a frame by weighted least squares, together with the background and a small shift of
/// each dot. Dots with an unusual residual, such as two dots that were fitted as one, are excluded.
/// @param dots  sampled pixels of each dot
/// @return fitted profile. It is a single Gaussian unless the misfit of the Gaussian exceeds 0.5 % of the light and the
///         fit of five coefficients is significantly better than that of one: F ratio above 6, which noise exceeds with
///         a probability of 1e-4
FittedProfile fit_dot_profile(std::span<std::vector<ProfileSample> const> dots);

}  // namespace gladstone::inline tracking
