#pragma once

#include <vector>

#include "render/rays/ray_requirement.h"
#include "render/rays/rays_launch.h"
#include "render/scene/renderer.h"

namespace gladstone::inline rays {

/// Sequence of launches with increasing numbers of rays, among which the number for each source is chosen adaptively.
/// Contains a single launch if the number is not adaptive.
class RaysLadder {
 public:
  /// Returns a ladder of Sobol or random points: 32 rays, doubled at each step.
  /// @param shared  launch whose parameters, except the number of rays, apply to all steps
  static RaysLadder of_points(Scene const& scene, RenderPlan const& plan, RaysLaunch const& shared,
                              RenderImages images);
  /// Returns a ladder of cubature rules that fill the stop, with four times as many nodes at each step: from 4 on, or
  /// from 64 with a prescription or refracting elements. Returns a ladder of points where no rule is suitable: with
  /// elements that divide the light cone, for images without a PSF, for random sampling, and for non-adaptive ray
  /// numbers.
  static RaysLadder of_rules(Scene const& scene, RenderPlan const& plan, RaysLaunch const& shared, RenderImages images);

  std::size_t size() const { return launches_.size(); }
  RaysLaunch const& operator[](std::size_t step) const { return launches_[step]; }
  RequiredRayAccuracy const& goal() const { return goal_; }
  /// Returns the first step with at least this number of rays; otherwise the last step.
  std::size_t at_least(double rays) const;
  /// Returns the step that a source requires according to its rays at the given step; the same step if they suffice.
  /// @param light_per_weight  light in the image per unit of ray weight at this step
  std::size_t next(std::size_t step, RayPlacement sent, EdgeRaySpread const& rim, RaySums const* of_scramblings,
                   double light_per_weight) const;

  template <class Change>
  void change(Change&& change) {
    for (RaysLaunch& launch : launches_) change(launch);
  }

 private:
  RaysLadder(Scene const& scene, RenderPlan const& plan, RenderImages images);
  std::vector<RaysLaunch> launches_;
  RequiredRayAccuracy goal_;
};

}  // namespace gladstone::inline rays
