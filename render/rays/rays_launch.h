#pragma once

#include <optional>

#include "render/rays/aimed_sources.h"
#include "render/rays/stop_rule.h"
#include "render/scene/camera.h"
#include "render/scene/render_plan.h"
#include "render/scene/spot.h"

namespace gladstone::inline rays {

/// Treatment of the aperture stop's edge in a RaysLaunch.
enum class StopRim {
  smooth,  ///< smoothed over a width that depends on the number of rays, for rays that are vignetted there
  sharp,   ///< sharp, for rays that fill the stop exactly
};

/// Order of a source's rays in a launch. It has no effect on results, except on their rounding.
enum class RayOrder {
  sequence,    ///< order of the Sobol sequence, the cheapest
  neighbours,  ///< order of ordered_point() if the medium is on a grid, for devices where parallel rays that read the
               ///< same cells are faster
};

/// Shift of the entrance pupil on the aim plane, as seen from the points of one source instead of from its middle.
struct AimShift {
  Vec3d by_x{}, by_y{};  ///< shift of the pupil on the aim plane per offset of the source point in x and in y [1]
  double residual = 0;   ///< upper limit of the remaining change of the pupil over the source [m]
};

/// Ray-tracing parameters shared by all sources with the same number of rays.
struct RaysLaunch {
  Camera camera;  ///< camera; the edge of its stop as requested
  TracingOptions<double> tracing;
  BundleView choice;
  SpotView spot;
  std::uint64_t rays = 1;
  double z_b = 0;         ///< distance from the dots to the lens [m]
  double light_unit = 1;  ///< weight times source area of a fully lit pixel on the axis [m^2]
  double point_area = 0;  ///< area attributed to a point source: that seen by a pixel on the axis [m^2]
  StopRule rule;          ///< quadrature rule of rays that fill the stop; without rings, `choice` determines the
                          ///< sampling points
  bool ordered = false;   ///< points are in the order of ordered_point()

  RaysLaunch(Scene const& scene, RenderPlan const& plan, SpotView const& spot, StopRim rim = StopRim::smooth,
             RayOrder order = RayOrder::sequence);
  /// Returns the same launch with another number of rays.
  RaysLaunch with_rays(std::uint64_t number) const;

  /// Returns the light per unit of ray weight [fully lit px].
  double light_per_weight(double source_area) const {
    return (source_area > 0 ? source_area : point_area) / (static_cast<double>(rays) * light_unit);
  }
  /// Returns the entrance pupil as seen from a point; nullopt if no chief ray passes.
  std::optional<WorldApparentPupil> sight(Vec3d middle) const { return camera.apparent_pupil(middle); }
  /// Returns the shift of the entrance pupil over a source that is parallel to the XY plane.
  ///
  /// For a source up to as large as the pupil, the shift is zero and the residual is `reach`: rays are sent to the
  /// pupil as seen from the middle, enlarged by the source's size. This also applies if no chief ray passes close to
  /// the middle. For larger sources, the shift is a finite difference between entrance pupils as seen from six points.
  /// @param disc  entrance pupil as seen from the source's middle
  /// @param reach  maximum distance of a point of the source from its middle [m]
  AimShift aim_shift(WorldApparentPupil const& disc, Vec3d middle, double reach) const;
  /// Returns the target area of a source's rays.
  /// @param disc  entrance pupil as seen from the source's middle
  /// @param margin  upper limit of the deflection by the medium on the aim plane [m]
  AimedBundle<double> bundle(WorldApparentPupil const& disc, AimShift const& shift, double margin) const;
  /// Returns the margin for a source before its rays are traced: twice the largest deflection of its chief and edge
  /// rays plus 1 % of the entrance pupil's radius, or 0 if these are not deflected. Other rays may be deflected more:
  /// through a smooth volume up to 1.6, through a turbulent plane up to 5 times as much. A source whose margin is too
  /// small is traced again, which costs more than the 2 % of rays added by 1 % of the radius.
  /// @param shift  largest deflection of these rays on the aim plane [m]
  double first_margin(WorldApparentPupil const& disc, double shift) const;
  /// Returns the margin with which a source must be traced again [m]; nullopt if its margin suffices.
  /// @param shift  largest deflection of its rays on the aim plane [m]
  /// @throws DataError if no real set-up has such a deflection
  std::optional<double> wider_margin(double margin, double shift) const;

 private:
  /// Sets the number of rays and its division among scramblings.
  void set_rays(std::uint64_t number);
  /// Returns true if the edge of the stop is smoothed.
  bool soft() const;
};

}  // namespace gladstone::inline rays
