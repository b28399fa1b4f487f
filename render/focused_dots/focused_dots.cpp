#include "render/focused_dots/focused_dots.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/ray_record.h"

namespace gladstone {
namespace {

/// What every thread keeps of one dot's rays while it renders images (DotExposure) [bytes].
double ray_record_bytes(Setup const& setup) {
  bool const kept =
      setup.lens.focus == Focus::target && setup.lens.spot != SpotModel::none && std::isfinite(setup.lens.f_number);
  if (!kept) return 0;
  std::uint64_t const rays = setup.render.rays_per_dot.value_or(std::uint64_t{1} << 16);  // the most "auto" takes
  // a list that doubles as it grows holds one and a half times its last size for a moment
  return 1.5 * static_cast<double>(std::bit_ceil(rays) * sizeof(RayRecord<double>)) * thread_count();
}

}  // namespace

SceneView<double> FocusedDots::view(DotPattern const& sources) const {
  Setup const& setup = scene_->setup;
  SceneView<double> seen;
  seen.sources = sources.view(-setup.z_d);
  seen.bundle.lens_z = setup.z_a;
  seen.bundle.pupil_radius = scene_->chief_rays_only() ? 0.0 : scene_->pupil_radius();
  seen.bundle.seed = setup.render.seed;
  seen.bundle.sampling = setup.render.sampling;
  seen.bundle.scrambling_bits = scrambling_bits(scene_->rays_per_dot);
  if (!scene_->chief_rays_only()) seen.train.append(aperture_stop());
  seen.train.append(ThinLens<double>{setup.z_a, setup.lens.focal_length});
  seen.sensor = {setup.z_a + scene_->imaging.image_distance, setup.camera.pixel_pitch, setup.camera.columns,
                 setup.camera.rows};
  seen.tracing = {scene_->step, setup.medium.ambient_refractivity(), setup.medium.integrator, setup.medium.faces};
  return seen;
}

SceneView<double> FocusedDots::open_view() const {
  SceneView<double> open = view();
  open.train = {};
  open.train.append(ThinLens<double>{scene_->setup.z_a, scene_->setup.lens.focal_length});
  return open;
}

ApertureStop<double> FocusedDots::aperture_stop() const {
  return {scene_->setup.z_a, scene_->imaging.entrance_pupil / 2, scene_->stop_edge()};
}

TheoryModel FocusedDots::theory_model() const {
  return {std::min(scene_->step, scene_->medium.coarsest_step),
          scene_->setup.z_d,
          scene_->imaging.magnification,
          scene_->setup.ambient_index(),
          scene_->setup.camera.pixel_pitch,
          scene_->imaging.entrance_pupil / 2};
}

double FocusedDots::light_per_ray(DotPattern const& sources) const {
  double const px = scene_->setup.camera.pixel_pitch / scene_->imaging.magnification;
  double const size = sources.half_size / px;
  double area = sources.shape == SourceShape::disc ? pi * size * size : 4 * size * size;
  if (sources.half_size == 0) area = 1;  // a point sends as much light as a disc of one square pixel
  double const stop = scene_->imaging.entrance_pupil / 2;
  double const enlarged = scene_->chief_rays_only() ? 1.0 : scene_->pupil_radius() / stop;
  return area * enlarged * enlarged / static_cast<double>(scene_->rays_per_dot);
}

std::string reason_against_focused_dots(Setup const& setup) {
  if (setup.piv) return "particles are no flat dots";
  if (setup.lens.prescription) return "the lens is a prescription";
  if (setup.pose) return "the camera has a pose of its own";
  if (!setup.windows.empty()) return "there are windows";
  if (setup.camera.tilted()) return "the sensor is tilted";
  if (setup.camera.distorted()) return "the lens distorts";
  if (setup.lenslets) return "there are lenslets before the sensor";
  if (!setup.on_bench()) return "the camera is no ideal thin lens alone on its axis";
  if (std::isinf(setup.lens.f_number)) return "the lens has no stop (f_number = inf)";
  if (!(std::abs(setup.focus_distance() - setup.z_b()) <= 1e-12 * setup.z_b())) return "the dots are out of focus";
  return "";
}

std::optional<FocusedDots> focused_dots(Scene const& scene) {
  if (!reason_against_focused_dots(scene.setup).empty()) return std::nullopt;
  return FocusedDots(scene);
}

std::optional<FocusedDots> bench_rays(Scene const& scene) {
  if (!scene.setup.on_bench()) return std::nullopt;
  return FocusedDots(scene);
}

std::vector<MemoryNeed> focused_dots_memory(Setup const& setup) {
  return {{"render.rays_per_dot", "rays of a dot", ray_record_bytes(setup)},
          {"camera.pixels", "table of deflections", table_bytes_needed(setup)}};
}

}  // namespace gladstone
