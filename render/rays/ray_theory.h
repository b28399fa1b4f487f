#pragma once

#include "render/rays/source_tracer.h"
#include "render/scene/field_map.h"
#include "render/scene/source_cubature.h"
#include "render/scene/theory.h"

namespace gladstone::inline rays {

/// Integrals along a straight ray of the components of grad n perpendicular to the camera's axis.
struct TransverseGradientIntegral {
  Vec3d plain{};                       ///< integral of grad n [1]
  Vec3d lever_weighted{};              ///< integral of grad n times the axial distance from the ray's start [m]
  double refractivity = 0, depth = 0;  ///< integrals of n - 1 and of 1 over the distance along the axis [m]
};

/// Small-angle theory for any camera: Eq. 9 of Rajendran et al. (2019) with deflection and lever along the chief ray,
/// both relative to the camera's axis, times the derivative of the camera's projection in the dots' plane. For a thin
/// lens on the Z axis, this is the paper's formula, M Z_D / (n_0 p) times the integral of grad n over z.
class RayTheory {
 public:
  static constexpr int all_rings = 40;
  /// @param launch  determines the integration step and how rays are aimed
  /// @param shape  shape of extended sources
  /// @param extended  false: point sources
  /// @param most_rings  maximum number of rings of the rule over the stop; fewer give an approximate average
  RayTheory(Scene const& scene, RaysLaunch const& launch, SourceShape shape, bool extended, int most_rings = all_rings);

  /// Stores the theoretical displacements of one source: along its chief ray with lever Z_D and with the lever of each
  /// slice, and averaged over the rays that pass the stop.
  template <class Sources, class Medium>
  void record(RaysLaunch const& launch, Sources const& sources, Medium const& medium, std::uint64_t source,
              GroundTruth& truth) const {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    truth.eq9_px[source] = truth.chief_px[source] = truth.eq9_cone_px[source] = {nan, nan};
    Vec3d const middle = sources.middle(source);
    auto const seen = launch.camera.see({middle.x, middle.y}, plane_);
    if (!seen) return;
    CameraView<double> const camera = launch.camera.view();
    auto const chief = before_medium(camera, seen->chief);
    if (!chief) return;
    TransverseGradientIntegral const along = integrate(medium, *chief);
    truth.eq9_px[source] = shift(*seen, *chief, lever(*chief) * along.plain);
    truth.chief_px[source] = shift(*seen, *chief, along.lever_weighted);

    auto const disc = launch.sight(middle);
    if (!disc) return;
    // With the residual set to zero, the target area is the same fraction of the stop for all sources, see stop_share_.
    AimShift aim_shift = launch.aim_shift(*disc, middle, sources.reach());
    aim_shift.residual = 0;
    AimedBundle<double> const bundle = launch.bundle(*disc, aim_shift, 0);
    Vec2d sum{};
    double weight = 0;
    for (std::size_t i = 0; i < places_.points.size(); ++i) {
      throw_if_interrupted();
      for (std::size_t k = 0; k < pupil_.points.size(); ++k) {
        AimedRay<double> const aimed =
            ray_to(sources, bundle, source, places_.points[i], stop_share_ * pupil_.points[k]);
        RayHit<double> const hit = trace_ray(camera, NoMedium<double>{}, launch.tracing, aimed.ray, aimed.weight);
        auto const straight = before_medium(camera, aimed.ray);
        if (!reaches_sensor_plane(hit.status) || !straight) continue;
        double const share = aimed.weight * places_.weights[i] * pupil_.weights[k];
        sum += share * shift(*seen, *straight, integrate(medium, *straight).lever_weighted);
        weight += share;
      }
    }
    if (weight > 0) truth.eq9_cone_px[source] = sum / weight;
  }

  /// Returns the ray as it enters the medium, extended backwards in a straight line to the apparent plane of the dots;
  /// nullopt if the ray does not reach the medium.
  std::optional<Ray<double>> before_medium(CameraView<double> const& camera, Ray<double> ray) const;

  /// Integrates along the part of a straight ray inside the medium.
  /// @param start  ray, starting in the plane from which levers are measured
  template <class Medium>
  TransverseGradientIntegral integrate(Medium const& medium, Ray<double> const& start) const {
    TransverseGradientIntegral sum;
    double const cosine = dot(start.direction, axis_);
    along_field(medium, start, step_, [&](IndexSample<double> const& sample, double s, double ds) {
      Vec3d const slice = (ds * cosine) * (sample.gradient - dot(sample.gradient, axis_) * axis_);
      sum.plain += slice;
      sum.lever_weighted += (s * cosine) * slice;
      sum.refractivity += sample.refractivity * ds * cosine;
      sum.depth += ds * cosine;
    });
    return sum;
  }

  /// Number of rays over which a source's aperture average is taken.
  std::size_t rays() const { return places_.points.size() * pupil_.points.size(); }

  /// Distance from a ray's start to the medium's mid-plane along the camera's axis [m].
  double lever(Ray<double> const& start) const {
    return -start.position.z / start.direction.z * dot(start.direction, axis_);
  }
  /// Returns the displacement in the image for a lever-weighted integral of the gradient [px].
  Vec2d shift(ImagedPoint const& seen, Ray<double> const& ray, Vec3d lever_weighted) const;

 private:
  Pose<double> plane_;
  Vec3d axis_;
  double step_, n0_;
  double stop_share_ = 1;          ///< fraction of a launch's target area that the stop fills, as a ratio of radii [1]
  SourceCubature places_, pupil_;  ///< rules over a source and over the stop
  double near_shift_ = 0;          ///< apparent shift of the dots by elements in front of the medium [m]
};

/// Estimates the processor time of small-angle theory for a scene's dots [s], with theory_ray_seconds() per ray.
double theory_seconds(Scene const& scene, RenderPlan const& plan);

/// map_field() and map_strain() (field_map.h) for any camera. The aperture average uses a few rays only.
FieldMap map_field_by_rays(Scene const& scene, RenderPlan const& plan, int spacing_px);
StrainMap map_strain_by_rays(Scene const& scene, RenderPlan const& plan);

}  // namespace gladstone::inline rays
