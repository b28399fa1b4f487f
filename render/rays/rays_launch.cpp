#include "render/rays/rays_launch.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/scene/shift_limit.h"

namespace gladstone {

RaysLaunch::RaysLaunch(Scene const& scene, SpotView const& shown, StopRim rim)
    : camera(scene.camera),
      tracing{scene.step, scene.setup.medium.ambient_refractivity(), scene.setup.medium.integrator,
              scene.setup.medium.faces},
      spot(shown),
      rays(scene.rays_per_dot),
      z_b(scene.setup.z_b()) {
  choice.seed = scene.setup.render.seed;
  choice.sampling = scene.setup.render.sampling;
  choice.scrambling_bits = scrambling_bits(rays);
  if (rim == StopRim::smooth && !camera.chief_rays_only()) camera.smooth_stop(scene.stop_edge());
  // Light of a pixel on the axis: the area that it sees times the cosine and the solid angle of its light cone.
  auto const seen = camera.unproject(camera.sensor.axis_pixel(), scene.target_plane());
  if (!seen) throw DataError("lens", "the camera's axis meets no place of the dots' plane; check the geometry");
  point_area = 1 / std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x);
  Vec3d const from = scene.target_plane().point_outwards({seen->place.x, seen->place.y, 0});
  double const cosine = std::abs(seen->chief.direction.z);
  if (camera.chief_rays_only()) {
    Vec3d const way = camera.aim_plane.origin - from;
    light_unit = point_area * cosine * std::abs(dot(seen->chief.direction, camera.aim_plane.z)) / dot(way, way);
  } else {
    double const slope = camera.paraxial.marginal_slope(camera.paraxial.front - camera.pose.point_inwards(from).z);
    light_unit = point_area * cosine * pi * slope * slope;
  }
}

RaysLaunch RaysLaunch::with_rays(std::uint64_t number) const {
  RaysLaunch other = *this;
  other.rays = number;
  other.choice.scrambling_bits = scrambling_bits(number);
  if (soft()) other.camera.smooth_stop(Scene::stop_edge(static_cast<double>(number)));
  return other;
}

bool RaysLaunch::soft() const {
  if (camera.chief_rays_only()) return false;
  return camera.elements[static_cast<std::size_t>(camera.stop)].visit([](auto const& held) {
    if constexpr (std::is_same_v<std::decay_t<decltype(held)>, PosedStop<double>>) return held.edge > 0;
    return false;
  });
}

AimedBundle<double> RaysLaunch::bundle(WorldAimDisc const& disc, double reach, double margin) const {
  if (camera.chief_rays_only()) return {disc.centre, {}, {}, camera.aim_plane.z, choice};
  // Semi-axes are the singular values of (a b), computed from their sum of squares and their product.
  double const squares = dot(disc.a, disc.a) + dot(disc.b, disc.b), area = length(cross(disc.a, disc.b));
  double const smaller = std::sqrt(0.5 * (squares - std::sqrt(std::max(0.0, squares * squares - 4 * area * area))));
  double const rim = soft() ? std::sqrt(1 + Scene::stop_edge(static_cast<double>(rays)) / 2) : 1;
  double const wider = rim + (margin + reach) / smaller;
  AimedBundle<double> bundle{disc.centre, wider * disc.a, wider * disc.b, {}, choice};
  bundle.across = pi * cross(bundle.a, bundle.b);
  return bundle;
}

double RaysLaunch::wider_margin(double shift) const {
  double const margin = 1.02 * shift;
  refuse_shift_beyond_any_bench(margin, z_b);
  return margin;
}

}  // namespace gladstone
