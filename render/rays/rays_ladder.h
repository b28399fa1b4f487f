#pragma once

#include <vector>

#include "render/rays/ladder_view.h"
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
  LadderView const& view() const { return view_; }

 private:
  RaysLadder(Scene const& scene, RenderPlan const& plan, RenderImages images);
  void add(RaysLaunch launch);

  std::vector<RaysLaunch> launches_;
  LadderView view_;
};

}  // namespace gladstone::inline rays
