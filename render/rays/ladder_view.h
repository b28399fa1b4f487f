#pragma once

#include "render/rays/ray_requirement.h"

namespace gladstone::inline rays {

/// Numbers of rays among which that of each source is chosen, for CPU and GPU (see RaysLadder).
struct LadderView {
  static constexpr int max_step_count = 16;
  static constexpr double least_clipped = 32;  ///< minimum number of rays that are vignetted at the stop; with fewer,
                                               ///< the smoothed zone at the edge of the stop is too wide

  RequiredRayAccuracy goal;
  int steps = 0;
  bool ruled = false;  ///< rays that fill the stop are sent to the nodes of cubature rules
  std::uint64_t rays[max_step_count] = {};
  int scrambling_bits[max_step_count] = {};

  /// Returns the first step with at least the wanted number of rays; otherwise the last step.
  GLADSTONE_HD int at_least(double wanted) const {
    int step = 0;
    while (step + 1 < steps && static_cast<double>(rays[step]) < wanted) ++step;
    return step;
  }
  /// Returns the first step of a source whose rays fill the stop.
  /// @param light  light of the source's image
  /// @param spread2  as FilledStop::spread2 [px^2]
  GLADSTONE_HD int step_filled(double light, double spread2) const {
    return at_least(estimate_rays_for_spread(goal, ruled ? RayPlacement::by_rule : RayPlacement::clipped, light,
                                             spread2, static_cast<double>(rays[0])));
  }
  /// Returns the first step of a source whose rays are vignetted at the stop.
  GLADSTONE_HD int step_clipped() const { return at_least(least_clipped); }
  /// Returns the step that a source requires according to its rays at the given step; the same step if they suffice.
  /// @param light_per_weight  light in the image per unit of ray weight at this step
  GLADSTONE_HD int next(int step, RayPlacement sent, EdgeRaySpread const& rim, RaySums const* of_scramblings,
                        double light_per_weight) const {
    if (step + 1 >= steps) return step;
    auto const here = static_cast<double>(rays[step]);
    double const asked =
        estimate_required_rays(goal, sent, rim, of_scramblings, 1 << scrambling_bits[step], here, light_per_weight);
    if (!(asked > here)) return step;
    int const found = at_least(asked);
    return found > step ? found : step + 1;
  }
};

}  // namespace gladstone::inline rays
