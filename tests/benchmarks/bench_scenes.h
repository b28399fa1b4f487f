#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string>

#include "render/focused_dots/focused_dots_renderer.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/lens.h"
#include "render/optics/paraxial.h"
#include "render/optics/prescription.h"
#include "tests/scene/planned_scene.h"

namespace gladstone::bench {

/// Width of the density field of the demo [m].
inline constexpr double volume_width = 32.7e-3;
inline constexpr double ambient_refractivity = 2.26e-4 * 1.225;

/// A seeded smooth refractivity that varies along all three axes, over five to ten cells of a 64^3 grid.
inline double smooth_refractivity(Vec3d p, unsigned seed) {
  double sum = 0;
  double phase = 0.1 * seed;
  for (int mode = 1; mode <= 4; ++mode) {
    Vec3d const k{900.0 + 210 * mode, 1500.0 - 170 * mode, 700.0 + 260 * (mode % 3)};
    phase += 1.7 + 0.3 * seed;
    sum += std::sin(k.x * p.x + phase) * std::cos(k.y * p.y - 0.6 * phase) * std::sin(k.z * p.z + 2.1 * phase) / mode;
  }
  return ambient_refractivity * (1 + 0.1 * sum);
}

/// Table 1 with no medium yet and `per_side`^2 dots of 3 px on a square lattice whose rays all cross the volume from
/// face to face, or 0: its own random dots, 20 a window of 32 px; a fixed number of rays per dot.
inline PlannedScene table1_scene(int per_side, std::uint64_t rays_per_dot, int pixels = 512) {
  Setup setup;
  setup.camera.columns = setup.camera.rows = pixels;
  setup.target.kind = TargetKind::dots;
  setup.target.dots_per_32px_window = per_side > 0 ? 1 : 20;
  PlannedScene scene(build_scene(setup));
  scene.setup.render.rays_per_dot = scene.plan.given_rays = scene.plan.rays = rays_per_dot;
  if (per_side == 0) return scene;
  double const edge = 36.0, pitch = (setup.camera.columns - 1 - 2 * edge) / (per_side - 1);
  scene.dots.centre.clear();
  for (int j = 0; j < per_side; ++j) {
    for (int i = 0; i < per_side; ++i)
      scene.dots.centre.push_back(scene.to_target({edge + i * pitch, edge + j * pitch}));
  }
  return scene;
}

enum class Interpolate { spline, linear };

/// Table 1 through a cube of nodes^3, 32.7 mm wide, RK4 with steps of one cell.
inline PlannedScene volume_scene(int nodes, int per_side, std::uint64_t rays_per_dot,
                                 Interpolate interpolate = Interpolate::spline) {
  PlannedScene scene = table1_scene(per_side, rays_per_dot);
  RegularGrid grid;
  grid.nodes = {nodes, nodes, nodes};
  double const cell = volume_width / (nodes - 1);
  grid.spacing = {cell, cell, cell};
  grid.origin = {-volume_width / 2, -volume_width / 2, -volume_width / 2};
  auto const fill = [&](int first, int count, std::span<double> out) {
    std::size_t at = 0;
    for (int k = first; k < first + count; ++k) {
      for (int j = 0; j < nodes; ++j) {
        for (int i = 0; i < nodes; ++i) {
          Vec3d const node{grid.origin.x + i * cell, grid.origin.y + j * cell, grid.origin.z + k * cell};
          out[at++] = static_cast<float>(smooth_refractivity(node, 1));
        }
      }
    }
  };
  using Volume = RefractiveIndexVolume<float>;
  bool const spline = interpolate == Interpolate::spline;
  auto const volume = std::make_shared<Volume const>(
      grid, spline ? Volume::Interpolation::cubic_bspline : Volume::Interpolation::trilinear, 1.0, 0.0, fill);
  if (spline) {
    scene.medium.view = volume->view<double, CubicBspline, 3>(0, 0);
  } else {
    scene.medium.view = volume->view<double, Linear, 3>(0, 0);
  }
  scene.medium.owner = volume;
  scene.medium.grid = grid;
  scene.medium.finest = scene.medium.coarsest_step = cell;
  scene.setup.medium.thickness = volume_width;
  scene.setup.medium.step_mm = cell * 1e3;
  plan_step(scene);
  return scene;
}

/// Table 1 through the late DNS plane, stacked over 10 mm as in the demo.
inline PlannedScene plane_scene(int per_side, std::uint64_t rays_per_dot, int pixels = 512) {
  PlannedScene scene = table1_scene(per_side, rays_per_dot, pixels);
  MediumSetup& medium = scene.setup.medium;
  medium.field.kind = FieldKind::file;
  medium.field.file = std::string(GLADSTONE_DATA_DIR) + "/fields/hbdt512_late_slice.h5";
  medium.field.where = "benchmark";
  medium.field.scale = 1.225;
  medium.field.spacing = Vec3d{0.0625e-3, 0.0625e-3, 0.0625e-3};
  medium.field.extrude = true;
  medium.field.periodic = {true, true, false};
  scene.medium = build_medium(medium);
  medium.step_mm = 2.5;
  plan_step(scene);
  return scene;
}

/// Returns the setup of Table 1 with the double Gauss of data/lenses as its lens.
inline Setup double_gauss_setup() {
  Setup setup;
  LensOptions options;
  options.f_number = setup.lens.f_number;
  auto const lens = std::make_shared<Lens const>(
      build_lens(read_prescription(std::string(GLADSTONE_DATA_DIR) + "/lenses/double_gauss.toml"),
                 GlassCatalogue::shipped(), setup.medium.wavelength, options));
  setup.lens.prescription = lens;
  setup.lens.focal_length = paraxial_lens(*lens).effective_focal_length;
  return setup;
}

/// Point sources out of focus by 2 px, 10,000 rays each, no medium.
/// @param dots_per_window of 32 x 32 px
inline PlannedScene points_scene(Setup setup, double dots_per_window = 1) {
  setup.target.kind = TargetKind::dots;
  setup.target.dots_per_32px_window = dots_per_window;
  setup.target.dot_diameter_px = 0;
  setup.lens.focus = Focus::distance;
  // Defocus of 2 px: width of the cone at the sensor, d_A |z_i - z| / z.
  setup.lens.focus_distance = setup.z_b() * (1 - 0.0168);
  PlannedScene scene(build_scene(setup));
  scene.plan.rays = 10000;
  scene.plan.step = setup.medium.thickness;
  return scene;
}

/// Returns straight rays from every `every`-th dot of a scene to the pupil.
inline std::vector<Ray<double>> rays_of_dots(PlannedScene const& scene, std::size_t every, int rays_a_dot) {
  FocusedSetupView const bench = build_focused_dots(scene, scene.plan).value().bench();
  BundleView choice;
  choice.scrambling_bits = scrambling_bits(static_cast<std::uint64_t>(rays_a_dot));
  std::vector<Ray<double>> rays;
  for (std::size_t dot = 0; dot < scene.dots.centre.size(); dot += every) {
    Vec2d const centre = scene.dots.centre[dot];
    for (int k = 0; k < rays_a_dot; ++k) {
      auto const [place, at] = DotRay::choose(choice, scene.dots.shape, centre, k);
      rays.push_back(
          bench.straight_ray(centre + scene.dots.half_size * place, (scene.imaging.entrance_pupil / 2) * at));
    }
  }
  return rays;
}

/// The rays of a scene where they enter the volume.
inline std::vector<Ray<double>> entering_rays(PlannedScene const& scene, SplineVolume<double> const& volume) {
  std::vector<Ray<double>> rays = rays_of_dots(scene, 1, static_cast<int>(scene.plan.rays));
  for (Ray<double>& start : rays) {
    start.position += start.direction * ((volume.box.low.z - start.position.z) / start.direction.z);
  }
  return rays;
}

/// Rays of a rendering in one frame.
inline double rays_of(PlannedScene const& scene) {
  return static_cast<double>(scene.dots.centre.size()) * static_cast<double>(scene.plan.rays);
}
/// RK4 steps that they take, but for their slant (below 0.1 %).
inline double steps_of(PlannedScene const& scene) {
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  return rays_of(scene) * std::round((box.high.z - box.low.z) / scene.plan.step);
}

}  // namespace gladstone::bench
