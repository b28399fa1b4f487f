#include "render/rays/ray_theory.h"

#include "render/base/parallel.h"

namespace gladstone::inline rays {

RayTheory::RayTheory(Scene const& scene, RaysLaunch const& launch, SourceShape shape, bool extended, int most_rings)
    : plane_(scene.target_plane()),
      axis_(scene.camera.pose.z),
      step_(std::min(launch.tracing.step, scene.medium.coarsest_step)),
      n0_(scene.setup.ambient_index()),
      places_(!extended ? SourceCubature{{{0, 0}}, {1.0}}
                        : (shape == SourceShape::disc ? SourceCubature::radon() : SourceCubature::square(3))),
      near_shift_(scene.setup.element_shift(ElementSide::target)) {
  pupil_ = {{{0, 0}}, {1.0}};
  if (launch.camera.chief_rays_only()) return;
  // Use enough rings and directions for waves of three times the field's finest length across the cone.
  double const radius = scene.imaging.entrance_pupil / 2 * scene.setup.z_d / scene.setup.z_b();
  double const lengths = scene.medium.finest > 0 ? radius / scene.medium.finest : 0;
  int const rings = std::min(most_rings, static_cast<int>(std::ceil(0.35 * lengths)) + 4);
  int const directions = std::min(6 * most_rings, 4 * static_cast<int>(std::ceil(0.45 * lengths + 3)));
  pupil_ = SourceCubature::disc(rings, 6, directions);
  double const seen = launch.camera.pupil_safety_factor();
  AimedBundle<double> const whole = launch.bundle({{}, {1, 0, 0}, {0, 1, 0}}, {}, 0);
  stop_share_ = 1 / (length(whole.a) * seen);
}

std::optional<Ray<double>> RayTheory::before_medium(CameraView<double> const& camera, Ray<double> ray) const {
  RayAccount<double> account;
  carry(camera, 0, camera.before_medium, ray, account);
  if (account.weight == 0 || !(ray.direction.z > 0)) return std::nullopt;
  double const way = (plane_.origin.z + near_shift_ - ray.position.z) / ray.direction.z;
  ray.position = ray.position + way * ray.direction;
  return ray;
}

Vec2d RayTheory::shift(ImagedPoint const& seen, Ray<double> const& ray, Vec3d lever_weighted) const {
  // Dots appear displaced against grad n; project the displacement along the ray onto their plane.
  Vec3d const across = (-1 / n0_) * lever_weighted;
  Vec3d const moved = across - (across.z / ray.direction.z) * ray.direction;
  return seen.moved({moved.x, moved.y});
}

double theory_seconds(Scene const& scene, RenderPlan const& plan) {
  constexpr double a_trace = 0.2e-6;  // time for aiming a ray and tracing it through the optics [s]
  RaysLaunch const launch(scene, plan, SpotView{});
  RayTheory const theory(scene, launch, scene.dots.shape, scene.dots.half_size > 0);
  double const rays = static_cast<double>(scene.dots.centre.size()) * static_cast<double>(theory.rays());
  return rays * (a_trace + theory_ray_seconds(scene, plan));
}

FieldMap map_field_by_rays(Scene const& scene, RenderPlan const& plan, int spacing_px) {
  FieldMap map = FieldMap::ambient(scene.setup, spacing_px);
  RaysLaunch const launch(scene, plan, SpotView{});
  RayTheory const theory(scene, launch, SourceShape::disc, false);
  CameraView<double> const camera = scene.camera.view();
  std::visit(
      [&](auto const& medium) {
        parallel_for(static_cast<std::size_t>(map.density.rows()), [&](std::size_t line) {
          int const row = static_cast<int>(line);
          for (int column = 0; column < map.density.columns(); ++column) {
            throw_if_interrupted();
            auto const seen = scene.camera.unproject(map.position_px(column, row), scene.target_plane());
            auto const chief = seen ? theory.before_medium(camera, seen->chief) : std::nullopt;
            if (!chief) continue;
            TransverseGradientIntegral const along = theory.integrate(medium, *chief);
            map.eq9_px(column, row) = theory.shift(*seen, *chief, theory.lever(*chief) * along.plain);
            if (!(along.depth > 0)) continue;
            double const mean = 1 / (scene.setup.medium.gladstone_dale * along.depth);
            map.density(column, row) = along.refractivity * mean;
            map.density_gradient(column, row) = mean * Vec2d{along.plain.x, along.plain.y};
          }
        });
      },
      scene.medium.view);
  return map;
}

StrainMap map_strain_by_rays(Scene const& scene, RenderPlan const& plan) {
  CameraSetup const& setup = scene.setup.camera;
  int const spacing_px = std::max(4, std::max(setup.columns, setup.rows) / 64);
  int const columns = std::max(3, setup.columns / spacing_px), rows = std::max(3, setup.rows / spacing_px);
  RaysLaunch const launch(scene, plan, SpotView{});
  RayTheory const theory(scene, launch, SourceShape::disc, false, 3);
  Image<Vec2d> displacement(columns, rows);
  std::visit(
      [&](auto const& medium) {
        parallel_for(static_cast<std::size_t>(rows), [&](std::size_t line) {
          GroundTruth truth;
          truth.resize(1);
          for (int column = 0; column < columns; ++column) {
            auto const seen = scene.camera.unproject(
                {(column + 0.5) * spacing_px - 0.5, (static_cast<double>(line) + 0.5) * spacing_px - 0.5},
                scene.target_plane());
            if (!seen) continue;
            LambertSources<double> const point{{&seen->place, nullptr, 1, -scene.setup.z_d, 0, SourceShape::disc}};
            theory.record(launch, point, medium, 0, truth);
            Vec2d const found = truth.eq9_cone_px[0];
            if (std::isfinite(found.x)) displacement(column, static_cast<int>(line)) = found;
          }
        });
      },
      scene.medium.view);
  return compute_strain(displacement, spacing_px);
}

}  // namespace gladstone::inline rays
