#include "render/rays/particles_in_view.h"

#include <algorithm>
#include <optional>

#include "render/base/parallel.h"
#include "render/scene/spot.h"
#include "render/scene/trace_ray.h"

namespace gladstone::inline rays {
namespace {

constexpr double spare_px = 8;
constexpr double within_rim = 0.9;  // radius of the tested rays relative to the entrance pupil, so that they pass
constexpr double blur_factor = 1.5, shift_factor = 2, lever_factor = 2;

/// Returns the upper limit of the displacement of an image in the object plane over the deflection of its rays on the
/// lens plane [1]. A deflection at z displaces the image in proportion to the distance back to the particle, and the
/// ray at the lens in proportion to the distance on to the lens; a safety factor of two is included.
double image_shift_per_lens_shift(Scene const& scene, Particles const& particles) {
  if (scene.setup.pose || particles.size() == 0) return shift_factor;
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  double deepest = particles.place[0][0].z;
  for (auto const& places : particles.place) {
    for (Vec3d const& place : places) deepest = std::min(deepest, place.z);
  }
  double const back = box.high.z - deepest, onward = scene.camera.aim_plane.origin.z - box.high.z;
  if (!(back >= 0) || !(onward > 0)) return shift_factor;
  return std::min(shift_factor, lever_factor * back / onward);
}

/// Returns true if the image of a point reaches a sensor enlarged by a margin on all sides, or if no chief ray is
/// found.
bool reaches(Camera const& camera, Vec3d place, double margin_px) {
  std::optional<Vec2d> const chief = camera.project(place);
  if (!chief) return true;
  Vec2d const last{camera.sensor.columns - 1.0, camera.sensor.rows - 1.0};
  Vec2d const beside{std::max({-chief->x, chief->x - last.x, 0.0}), std::max({-chief->y, chief->y - last.y, 0.0})};
  double const apart = std::max(beside.x, beside.y);
  if (apart <= margin_px) return true;
  if (camera.chief_rays_only()) return false;
  auto const disc = camera.apparent_pupil(place);
  if (!disc) return true;
  CameraView<double> const view = camera.view();
  double blur_px = 0;
  int passing = 0;
  for (Vec3d const rim : {disc->a, disc->b, -disc->a, -disc->b}) {
    Ray<double> const ray{place, normalized(disc->centre + within_rim * rim - place)};
    RayHit<double> const hit = trace_ray(view, NoMedium<double>{}, TracingOptions<double>{}, ray, 1.0);
    if (!reaches_sensor_plane(hit.status)) continue;
    ++passing;
    blur_px = std::max(blur_px, length(hit.pixel - *chief) / within_rim);
  }
  return passing == 0 || !(apart > margin_px + blur_factor * blur_px);
}

}  // namespace

std::vector<char> particles_near_view(Scene const& scene, RenderPlan const& plan, Particles const& particles) {
  std::vector<char> near(particles.size(), 1);
  if (scene.setup.divides_light()) return near;
  std::optional<AiryTable> airy;
  double const px_per_metre = scene.imaging.magnification / scene.setup.camera.pixel_pitch;
  double const margin_px = scene.setup.view_margin_px + make_spot(scene, airy).half_width() + spare_px +
                           image_shift_per_lens_shift(scene, particles) * plan.pupil_margin * px_per_metre;
  parallel_chunks(particles.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      bool found = false;
      for (std::size_t pulse = 0; pulse < 2 && !found; ++pulse) {
        found = particles.photons[pulse][i] > 0 && reaches(scene.camera, particles.place[pulse][i], margin_px);
      }
      near[i] = found ? 1 : 0;
    }
  });
  return near;
}

}  // namespace gladstone::inline rays
