#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/tracking/gaussian_dot.h"
#include "render/base/image.h"

namespace gladstone::inline tracking {

/// Dot measured in a frame.
struct LocatedDot {
  GaussianDot image;           ///< fitted Gaussian; flux of dark dots: light missing from the background
  Vec2d sigma_px{};            ///< standard uncertainty of the centre [px]
  double flux_sigma = 0;       ///< standard uncertainty of the flux [grey levels]
  double reduced_chi2 = 0;     ///< chi2 of the joint fit divided by its degrees of freedom [1]
  double background = 0;       ///< constant of the joint fit, which is added to the estimated background [grey levels]
  double freedom_share = 0;    ///< degrees of freedom of the joint fit divided by its number of pixels [1]
  std::size_t group_size = 1;  ///< number of dots that were fitted together
};

/// Dots of a frame.
struct LocatedDots {
  std::vector<LocatedDot> dots;  ///< sorted by row, then column of the nearest pixel
  bool bright = true;            ///< polarity: true if the dots are brighter than the background
  double noise = 0;              ///< standard deviation of the noise in the background [grey levels]
  /// Variance of the shot noise per grey level of light [grey levels/e]; 0: no shot noise.
  double gain = 0;
  double diameter_px = 0;    ///< median e^-2 diameter of the isolated dots, four standard deviations [px]
  std::size_t rejected = 0;  ///< number of candidates without a valid fit
  Image<double> light;       ///< fitted light of all dots [grey levels]
  Image<double> residual;    ///< levels above the estimated background minus the light of all dots [grey levels]
};

/// Returns the factor by which the misfit of a dot increases its sigma_px: the square root of the reduced chi2, but at
/// least one.
double misfit_factor(LocatedDot const& dot);

/// Returns the standard deviation of the noise of a pixel with the given light of dots, at least 1e-9 [grey levels].
double noise_with_light(double background_noise, double gain, double light);

/// Locates the dots (BOS) or particles (PIV) of a frame by least-squares fits of Gaussians, or of the common profile of
/// round dots (fit_dot_profile()).
///
/// Candidates are maxima of the filtered frame. Dots whose images overlap are fitted together, and dots are added where
/// the residual is significant (fit_overlapping_dots()); the light of all other dots is subtracted first, as in DAOPHOT
/// (Stetson, PASP 99 (1987) 191). Background, noise and the distribution of widths are estimated from the frame and
/// updated after each of four sweeps. For bright dots, the noise includes the shot noise of their light
/// (estimate_conversion_gain()): if only the noise of the background were used, sigma would be too small wherever the
/// light of a dot exceeds the squared background noise divided by the gain. The uncertainty of a centre is the
/// Cramer-Rao bound of its fit (inverse Fisher information; for BOS dots see Rajendran, Bane & Vlachos, Exp. Fluids 61
/// (2020) 139) times the square root of the reduced chi2 where the latter exceeds one. For uncorrelated noise, the
/// errors of isolated Gaussian dots are as small as this bound. The result is bitwise the same for any number of
/// threads.
/// @param frame  grey levels; pixels that are not finite are ignored
/// @return located dots; none if no dot exceeds the noise or the frame is smaller than 5x5 px
/// @throws Interrupted
LocatedDots locate_dots(Image<double> const& frame, DotSettings const& settings);

/// Locates dots near known places, for example those of a printed pattern, instead of searching for maxima and adding
/// dots where images overlap.
/// @param places  approximate centres, within about one standard deviation of a dot image [px]; places that are outside
///                the frame or not finite are ignored
/// @return located dots, as returned by locate_dots(); none for a place at which no dot is significant
LocatedDots locate_dots_near(Image<double> const& frame, DotSettings const& settings, std::span<Vec2d const> places);

}  // namespace gladstone::inline tracking
