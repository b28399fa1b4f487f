#pragma once

#include <optional>

#include "render/rays/aimed_sources.h"
#include "render/rays/stop_rule.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"
#include "render/scene/spot.h"

namespace gladstone {

/// The rim of a launch's stop.
enum class StopRim {
  smooth,  ///< for rays that are clipped there: as wide as their number asks for
  sharp,   ///< as it is, for rays that fill the stop and nothing else
};

/// What all sources of a launch share.
struct RaysLaunch {
  Camera camera;  ///< its stop with the rim asked for
  TracingOptions<double> tracing;
  BundleView<double> choice;
  SpotView spot;
  std::uint64_t rays = 1;
  double z_b = 0;         ///< from the dots to the lens [m]
  double light_unit = 1;  ///< of weight times source area: a fully lit pixel on the axis [m^2]
  double point_area = 0;  ///< that a source of no size counts as: what a pixel on the axis sees [m^2]
  StopRule rule;          ///< that rays which fill the stop go by; of no rings: by `choice`

  RaysLaunch(Scene const& scene, SpotView const& spot, StopRim rim = StopRim::smooth);
  /// The same of so many rays.
  RaysLaunch with_rays(std::uint64_t number) const;

  /// Light of one unit of a ray's weight [fully lit px].
  double light_per_weight(double source_area) const {
    return (source_area > 0 ? source_area : point_area) / (static_cast<double>(rays) * light_unit);
  }
  /// What a source at a point sees of the stop.
  std::optional<WorldAimDisc> sight(Vec3d middle) const { return camera.aim_disc(middle); }
  /// Where its rays go, if it reaches so far about the point, and the medium bends rays aside by `margin` at most [m].
  AimedBundle<double> bundle(WorldAimDisc const& disc, double reach, double margin) const;
  /// The margin for a source of which the medium moved a ray so far on the aim plane [m].
  /// @throws DataError where no bench has such a shift
  double wider_margin(double shift) const;

 private:
  /// Whether the stop's rim is smoothed.
  bool soft() const;
};

}  // namespace gladstone
