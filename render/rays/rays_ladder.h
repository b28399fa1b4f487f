#pragma once

#include <vector>

#include "render/rays/ray_need.h"
#include "render/rays/rays_launch.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// A scene's launches by their numbers of rays: one for all sources, or those that a source takes what it needs from.
class RaysLadder {
 public:
  /// Points of a sequence, from 32 on, every number twice the one before. @param shared by all but for their rays
  static RaysLadder of_points(Scene const& scene, RaysLaunch const& shared, RenderImages images);
  /// Nodes of rules that fill the stop, every number four times the one before: from 4 on, or from 64 where more than
  /// an ideal lens images. Points where no rule serves: behind lenslets, which cut a cone into pieces, and without a
  /// spot.
  static RaysLadder of_rules(Scene const& scene, RaysLaunch const& shared, RenderImages images);

  std::size_t size() const { return launches_.size(); }
  RaysLaunch const& operator[](std::size_t step) const { return launches_[step]; }
  RayGoal const& goal() const { return goal_; }
  /// The first of so many rays; the last where none has.
  std::size_t at_least(double rays) const;
  /// The step that a source needs by what its rays have come to at this one, which may be this one.
  /// @param light_per_weight of images at this step
  std::size_t next(std::size_t step, RaysSent sent, RimSpread const& rim, RaySums const* of_scramblings,
                   double light_per_weight) const;

  template <class Change>
  void change(Change&& change) {
    for (RaysLaunch& launch : launches_) change(launch);
  }

 private:
  RaysLadder(Scene const& scene, RenderImages images);
  std::vector<RaysLaunch> launches_;
  RayGoal goal_;
};

}  // namespace gladstone
