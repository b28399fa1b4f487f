#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/rays/source_truth.h"
#include "render/scene/ray_budget.h"

/// Number of rays that a source requires, determined from the source itself and the camera's exposure alone.
namespace gladstone::inline rays {

/// Placement of a source's rays. Determines how fast their errors decrease with the number of rays.
enum class RayPlacement {
  by_rule,  ///< rays at the nodes of a cubature rule that fill the stop (stop_rule.h)
  clipped,  ///< rays at the points of a sequence over a disc larger than the stop
};

/// Required accuracy of a source's light and truth.
struct RequiredRayAccuracy {
  double level = 0;         ///< light of one grey level; 0: no image is required
  double brightest_at = 0;  ///< grey levels of the brightest pixel of the image
  double spot2 = 0;         ///< squared radius of the PSF, as a smooth function [px^2]
  double most = 1;          ///< maximum number of rays per source

  /// Estimates the light in the brightest pixel of a source's image.
  /// @param light  total light of the source
  /// @param spread2  variance of its ray hits along an axis [px^2]
  GLADSTONE_HD double peak(double light, double spread2) const {
    double const pixels = 2 * pi * (spot2 + spread2);
    return pixels > 1 ? light / pixels : light;
  }
  /// Returns the allowed error of a source's image, rms over its lit pixels, relative to its peak [1].
  /// It is half a grey level for a source as bright as the image's brightest pixel and decreases with the square root
  /// of the light of fainter ones: the squared errors of overlapping sources then add up to half a level, short of
  /// saturation.
  GLADSTONE_HD double allowed(double peak) const {
    using std::sqrt;
    double const share = peak / (brightest_at * level);
    return image_tolerance_levels * level * sqrt(share < 1 ? share : 1.0) / peak;
  }
};

/// Returns true if a cubature rule with n nodes meets the allowed image error (rms over lit pixels, relative to the
/// peak), for rays that fill a disc.
/// The rule integrates the Taylor series of the PSF exactly to degree 2 sqrt(n) - 1. Empirical, for discs of 0.05 to 4
/// times the PSF's radius, PSFs of 0.1 to 1.5 px and 4 to 1024 nodes: correct within a factor of 3, or one step of n.
/// @param ratio2  variance of the hits along an axis over the PSF's squared radius (spot2) [1]
GLADSTONE_HD inline bool cubature_rule_suffices(double n, double ratio2, double allowed) {
  using std::log;
  using std::sqrt;
  return sqrt(n) * log(ratio2 / (5 + 0.085 * n)) <= log(allowed);
}

/// Estimates the image error of n rays at scrambled points, as in cubature_rule_suffices(): if few rays are within the
/// PSF's area, the error of their variance; if many are, the error of their number. Empirical, for discs of 0.1 to 24
/// times the PSF's radius, dots of 0 to 6 px and 32 to 16,384 rays: correct within a factor of 3.
GLADSTONE_HD inline double estimate_point_sampling_error(double n, double ratio2) {
  using std::pow;
  double const within = n / (1 + ratio2 / 4);
  double const of_variance = within < 256 ? 8 * pow(within, -0.9) : 0.0544 * pow(within / 256, -1.2);
  double const left = ratio2 / (1 + ratio2) * of_variance;
  return left < 1 ? left : 1.0;
}

/// Returns the number of rays that the spread of a source's hits requires.
/// @param n  start value, which is quadrupled (rule) or doubled (points)
GLADSTONE_HD inline double estimate_rays_for_spread(RequiredRayAccuracy const& goal, RayPlacement sent, double light,
                                                    double spread2, double n) {
  if (!(goal.level > 0 && light > 0)) return n;
  double const allowed = goal.allowed(goal.peak(light, spread2)), ratio2 = spread2 / goal.spot2;
  if (sent == RayPlacement::by_rule) {
    while (n < goal.most && !cubature_rule_suffices(n, ratio2, allowed)) n *= 4;
  } else {
    while (n < goal.most && !(estimate_point_sampling_error(n, ratio2) <= allowed)) n *= 2;
  }
  return n;
}

/// Properties of a source's rays known before they are traced, for each image.
struct EdgeRaySpread {
  double spread2[frame_count] = {};          ///< variance of the hits, see FilledStop::spread2, for rays placed by a
                                             ///< rule [px^2]
  bool clipped[frame_count] = {true, true};  ///< rays are sent to a disc larger than the stop and may all be vignetted
};

/// Returns the number of rays that a source requires according to its traced rays: the scatter of its displacement and
/// of its light between scramblings, and the spread of its image. Returns `rays` if these suffice.
/// For cubature rules, the next larger rule is requested, since their errors vanish abruptly with n; the variance of
/// points is assumed to decrease as 1/n.
///
/// Rotating a rule of one or two rings does not reveal its error from rotationally symmetric aberrations. This error is
/// estimated from the difference between the measured spread and that of the edge rays, which is as large as the error
/// of one ring and more than four times that of two (double Gauss and achromat, f/4 to f/11); the error of four rings
/// is negligible.
/// @param of  sums of the scramblings
/// @param light_per_weight  light in the image per unit of ray weight
GLADSTONE_HD inline double estimate_required_rays(RequiredRayAccuracy const& goal, RayPlacement sent,
                                                  EdgeRaySpread const& rim, RaySums const* of, int scramblings,
                                                  double rays, double light_per_weight) {
  using std::pow;
  using std::sqrt;
  bool const by_rule = sent == RayPlacement::by_rule;
  double asked = rays;
  auto const ask = [&asked](double n) {
    if (n > asked) asked = n;
  };
  RaySums all;
  for (int i = 0; i < scramblings; ++i) {
    all += of[i];
    for (int frame = 0; frame < frame_count; ++frame) {
      // Even if no ray passes, the source may be visible.
      if (rim.clipped[frame] && !(of[i].hits[frame].weight > 0)) ask(4 * rays);
    }
  }
  if (scramblings > 1 && all.hits[0].weight > 0 && all.hits[1].weight > 0) {
    Vec2d const squares = displacement_error2(of, scramblings, all);
    double const excess2 = (squares.x + squares.y) / (2 * truth_tolerance_px * truth_tolerance_px);
    if (excess2 > 1) ask(by_rule ? 4 * rays : rays * sqrt(excess2));
  }
  for (int frame = 0; goal.level > 0 && frame < frame_count; ++frame) {
    CentroidSum<double> const& hits = all.hits[frame];
    double const light = hits.weight * light_per_weight;
    if (!(light > 0)) continue;
    Vec2d const mean = hits.mean();
    double const square = (hits.second.x + hits.second.y) / hits.weight - dot(mean, mean);
    double const spread2 = square > 0 ? 0.5 * square : 0.0;
    double const allowed = goal.allowed(goal.peak(light, spread2));
    ask(estimate_rays_for_spread(goal, sent, light, spread2, rays));
    if (by_rule && rays < 64) {
      double const apart = spread2 - rim.spread2[frame], left = (rays < 16 ? 1.0 : 0.25) * (apart < 0 ? -apart : apart);
      if (0.4 * left / (goal.spot2 + spread2) > allowed) ask(4 * rays);
    }
    if (scramblings == 1) continue;
    double squares = 0;
    for (int i = 0; i < scramblings; ++i) {
      double const apart = of[i].hits[frame].weight - hits.weight / scramblings;
      squares += apart * apart;
    }
    // The rms over lit pixels is 0.4 to 0.7 of the peak.
    double const excess = 0.7 * sqrt(error2_factor(scramblings) * squares) / (hits.weight * allowed);
    if (excess > 1) ask(by_rule ? 4 * rays : rays * pow(excess, 1 / 1.5));
  }
  return asked;
}

}  // namespace gladstone::inline rays
