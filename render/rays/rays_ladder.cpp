#include "render/rays/rays_ladder.h"

#include <algorithm>
#include <utility>

#include "render/base/contracts.h"
#include "render/scene/spot.h"

namespace gladstone::inline rays {
namespace {

/// Returns true if the optics have aberrations (prescription or refracting elements), so that rays do not fill a disc
/// evenly.
bool aberrates(Setup const& setup) { return setup.lens.prescription || setup.has_refracting_elements(); }

/// Returns the squared radius of an equivalent smooth PSF, with which the errors of a cubature rule decrease as with
/// the actual PSF [px^2].
/// For wide PSFs, the variances of PSF and pixel add up; for narrow ones, the discontinuous pixel contributes at most
/// as much as the PSF. Aberrations concentrate rays, which is equivalent to half the squared radius (double Gauss at
/// f/4, 16 to 1024 nodes).
double smooth_spot2(Scene const& scene) {
  constexpr double least = 0.05, of_pixel = 1.0 / 12;
  double const airy = SpotSize{scene.spot_scale_px()}.matched_sigma();
  double const sigma = scene.setup.lens.spot == SpotModel::airy ? airy : scene.spot_sigma_px();
  double const crowded = aberrates(scene.setup) ? 0.5 : 1.0;
  return std::max(least * least, crowded * std::min(2 * sigma * sigma, sigma * sigma + of_pixel));
}

}  // namespace

RaysLadder::RaysLadder(Scene const& scene, RenderPlan const& plan, RenderImages images) {
  if (plan.adaptive_criteria && images != RenderImages::no) view_.goal.level = plan.adaptive_criteria->level;
  if (plan.adaptive_criteria) view_.goal.brightest_at = plan.adaptive_criteria->brightest_at;
  view_.goal.spot2 = smooth_spot2(scene);
}

void RaysLadder::add(RaysLaunch launch) {
  GLADSTONE_EXPECTS(view_.steps < LadderView::max_step_count);
  view_.rays[view_.steps] = launch.rays;
  view_.scrambling_bits[view_.steps] = launch.choice.scrambling_bits;
  view_.ruled = static_cast<bool>(launch.rule.view());
  view_.goal.most = static_cast<double>(launch.rays);
  ++view_.steps;
  launches_.push_back(std::move(launch));
}

RaysLadder RaysLadder::of_points(Scene const& scene, RenderPlan const& plan, RaysLaunch const& shared,
                                 RenderImages images) {
  constexpr std::uint64_t least = 32;
  RaysLadder ladder(scene, plan, images);
  for (std::uint64_t rays = least; plan.adaptive_criteria && rays < plan.rays; rays *= 2) {
    ladder.add(shared.with_rays(rays));
  }
  ladder.add(shared.with_rays(plan.rays));
  return ladder;
}

RaysLadder RaysLadder::of_rules(Scene const& scene, RenderPlan const& plan, RaysLaunch const& shared,
                                RenderImages images) {
  Setup const& setup = scene.setup;
  std::uint64_t const least = aberrates(setup) ? 64 : 4;
  bool const smooth = !setup.divides_light() && (images == RenderImages::no || shared.spot.model != SpotModel::none);
  bool const ruled =
      plan.adaptive_criteria && smooth && shared.choice.sampling == PupilSampling::sobol && !scene.chief_rays_only();
  if (!ruled || plan.rays < least) return of_points(scene, plan, shared, images);
  RaysLadder ladder(scene, plan, images);
  for (std::uint64_t rays = least; rays <= plan.rays; rays *= 4) {
    RaysLaunch launch = shared.with_rays(rays);
    launch.rule = StopRule(rays);
    launch.choice.scrambling_bits = rays < 64 ? 1 : 2;
    ladder.add(std::move(launch));
  }
  return ladder;
}

}  // namespace gladstone::inline rays
