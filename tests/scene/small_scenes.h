#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "render/focused_dots/focused_dots_renderer.h"
#include "render/rays/rays_renderer.h"
#include "tests/scene/planned_scene.h"

namespace gladstone {

/// Returns the setup of Table 1 with a smaller sensor: f = 105 mm, f/11, Z_A = 0.75 m, Z_D = 0.25 m, pixels of 10 um.
inline Setup table1_setup(int pixels) {
  Setup setup;
  setup.camera.columns = setup.camera.rows = pixels;
  return setup;
}

inline FieldSetup uniform_gradient(double along_x, double along_y, double along_z = 0) {
  return UniformGradient<double>{{}, {along_x, along_y, along_z}};
}

/// Returns the field rho = ambient + amplitude sin(2 pi d . x / wavelength), with amplitude in kg/m^3 and wavelength in
/// m.
inline FieldSetup sinusoid(double amplitude, double wavelength, Vec2d direction = {1, 0}) {
  return Sinusoid<double>::wave(amplitude, wavelength, direction);
}

/// Returns the DNS plane of an instant, scaled as in the demo: 1.225 kg/m^3, 32 mm, periodic in x and y, extruded over
/// the thickness.
inline FieldSetup dns_plane(std::string const& instant) {
  FieldSetup field;
  field.kind = FieldKind::file;
  field.file = std::string(GLADSTONE_DATA_DIR) + "/fields/hbdt512_" + instant + "_slice.h5";
  field.where = "test";
  field.scale = 1.225;
  field.spacing = Vec3d{0.0625e-3, 0.0625e-3, 0.0625e-3};
  field.extrude = true;
  field.periodic = {true, true, false};
  return field;
}

/// Returns a scene with dots at given positions in the reference image [px] and a given number of rays, with its step
/// and margin planned.
inline PlannedScene scene_with_dots(Setup const& setup, std::vector<Vec2d> const& at_px, std::uint64_t rays) {
  Setup bare = setup;
  bare.target.dots_per_32px_window = 1;
  bare.target.dot_diameter_px = 0;
  PlannedScene scene(build_scene(bare));
  scene.setup = setup;
  scene.dots.half_size = setup.dot_diameter() / 2;
  scene.dots.centre.clear();
  for (Vec2d const p : at_px) scene.dots.centre.push_back(scene.to_target(p));
  plan_step(scene);
  scene.setup.render.rays_per_dot = scene.plan.given_rays = scene.plan.rays = rays;
  return scene;
}

/// Renders a scene by the fast renderer, or by the general one if the fast renderer does not support all of its dots.
inline Rendering render_either(PlannedScene const& scene, RenderImages images, RenderTheory theory) {
  if (build_focused_dots(scene, scene.plan)) {
    Rendering rendering = FocusedDotsRenderer().render(scene, scene.plan, scene.dots, images, theory);
    if (rendering.left.empty()) return rendering;
  }
  return RaysRenderer().render(scene, scene.plan, scene.dots, images, theory);
}
inline Rendering render_all(PlannedScene const& scene) {
  return render_either(scene, RenderImages::yes, RenderTheory::yes);
}
inline GroundTruth trace_truth(PlannedScene const& scene, RenderTheory theory = RenderTheory::yes) {
  return render_either(scene, RenderImages::no, theory).truth;
}

/// Returns a lattice of points, `pitch` apart, in the middle of a square image [px].
inline std::vector<Vec2d> lattice(int pixels, int per_side, double pitch) {
  std::vector<Vec2d> points;
  for (int j = 0; j < per_side; ++j) {
    for (int i = 0; i < per_side; ++i) {
      points.push_back({0.5 * (pixels - 1) + (i - 0.5 * (per_side - 1)) * pitch + 0.37 * (j % 2),
                        0.5 * (pixels - 1) + (j - 0.5 * (per_side - 1)) * pitch + 0.21 * (i % 3)});
    }
  }
  return points;
}

/// Writes a plane of values f(i, j) as a raw NRRD file.
template <class Function>
void write_plane(std::string const& path, int columns, int rows, Function&& value) {
  std::ofstream file(path, std::ios::binary);
  file << "NRRD0004\ntype: float\ndimension: 3\nsizes: " << columns << " " << rows
       << " 1\nendian: " << (std::endian::native == std::endian::little ? "little" : "big") << "\nencoding: raw\n\n";
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      float const number = static_cast<float>(value(i, j));
      file.write(reinterpret_cast<char const*>(&number), sizeof number);
    }
  }
}

}  // namespace gladstone
