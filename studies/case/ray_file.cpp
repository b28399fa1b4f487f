#include "studies/case/ray_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/light/number_table.h"
#include "render/scene/trace_ray.h"

namespace gladstone::inline cases {
namespace {

/// Normalizes a direction, scaling by its largest component first to avoid overflow and underflow of its square.
Vec3d unit_direction(Vec3d d) {
  double const largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  return normalized(Vec3d{d.x / largest, d.y / largest, d.z / largest});
}

TracedRay dead(RayStatus status) {
  return {status,
          {not_a_number, not_a_number, not_a_number},
          {not_a_number, not_a_number, not_a_number},
          not_a_number,
          {not_a_number, not_a_number}};
}

/// Returns true if the element is in front of the ray.
bool runs_to(CameraElement<double> const& element, Ray<double> const& ray) {
  return element.visit([&](auto const& held) { return held.pose.point_to_local(ray.position).z < 0; });
}

template <class Medium>
TracedRay trace_one(Scene const& scene, TracingOptions<double> const& options, Medium const& medium,
                    Ray<double> const& start, Through through) {
  CameraView<double> const camera = scene.camera.view();
  TracedRay traced{RayStatus::alive, start.position, start.direction, 0.0, {not_a_number, not_a_number}};
  Ray<double> ray = start;
  RayAccount<double> account;
  for (int i = 0; i < camera.before_medium; ++i) {
    if (!runs_to(camera.elements[i], ray)) continue;
    RayStatus const status = pass_element(camera.elements[i], ray, account);
    if (status != RayStatus::alive) return dead(status);
  }
  MediumPassage<double> const way = trace_medium(medium, options, ray);
  if (way.status != RayStatus::alive) return dead(way.status);
  if (way.crossed) {
    Vec3d const left = exit_position(ray, way);
    // In an infinitely wide slab, a ray parallel to the faces never exits.
    if (std::max(std::abs(left.x), std::abs(left.y)) >= unbounded) return dead(RayStatus::lost_in_medium);
    ray = {left, exit_direction(ray, way)};
    account.optical_path += way.optical_path;
  }
  traced = {RayStatus::alive, ray.position, ray.direction, account.optical_path, {not_a_number, not_a_number}};
  if (through == Through::medium) return traced;
  bool const behind = camera.aim_plane.point_to_local(ray.position).z > 0;
  if (behind || !(camera.aim_plane.direction_to_local(ray.direction).z > 0)) return dead(RayStatus::missed_lens);
  for (int i = camera.before_medium; i < camera.count; ++i) {
    RayStatus const status = pass_element(camera.elements[i], ray, account);
    if (status != RayStatus::alive) return dead(status);
  }
  bool const thin = !scene.setup.lens.prescription;  // a thin lens has no defined optical path
  traced = {RayStatus::alive,
            ray.position,
            ray.direction,
            thin ? not_a_number : account.optical_path,
            {not_a_number, not_a_number}};
  if (through == Through::optics) return traced;
  Vec2d place;
  if (!camera.sensor.meet(ray, place)) return dead(RayStatus::missed_lens);
  traced.position = camera.sensor.pose.point_to_outer({place.x, place.y, 0});
  if (!thin) traced.optical_path += dot(traced.position - ray.position, ray.direction);
  traced.pixel = camera.sensor.to_pixel(place.x, place.y);
  if (!camera.sensor.covers(traced.pixel)) traced.status = RayStatus::missed_sensor;
  return traced;
}

/// Converts a row of a table of rays.
/// @param place  location of the row, for messages
Ray<double> make_ray(double const* v, std::string const& place, double farthest) {
  Vec3d const start = Vec3d{v[0], v[1], v[2]} * unit::millimetre;
  if (std::max({std::abs(start.x), std::abs(start.y), std::abs(start.z)}) > farthest) {
    throw DataError(ErrorCode::out_of_range, place,
                    fmt::format("the ray starts at {:.6g}, {:.6g}, {:.6g} mm, far outside the set-up ({:.6g} mm at "
                                "most, ten times the distance from the dots to the lens); positions are in mm",
                                v[0], v[1], v[2], farthest / unit::millimetre));
  }
  Vec3d const direction{v[3], v[4], v[5]};
  if (direction == Vec3d{}) throw DataError(ErrorCode::syntax, place, "the direction is zero; give any other vector");
  return {start, unit_direction(direction)};
}

}  // namespace

std::vector<Ray<double>> rays_of(std::vector<double> const& rows, std::string const& name, double farthest) {
  std::vector<Ray<double>> rays;
  for (std::size_t i = 0; i + 6 <= rows.size(); i += 6) {
    double const* const v = rows.data() + i;
    std::string const place = fmt::format("{}:{}", name, i / 6);
    bool const finite = std::all_of(v, v + 6, [](double value) { return std::isfinite(value); });
    if (!finite) throw DataError(ErrorCode::syntax, place, "is not six finite numbers");
    rays.push_back(make_ray(v, place, farthest));
  }
  return rays;
}

std::vector<Ray<double>> read_rays(std::string const& path, double farthest) {
  NumberTable file(path, "a table of rays with --rays", {"x_mm", "y_mm", "z_mm", "dx", "dy", "dz"});
  std::vector<Ray<double>> rays;
  while (auto const row = file.next()) {
    Ray<double> const ray = make_ray(row->data(), file.place(), farthest);
    require_room(rays, path, "rays");
    rays.push_back(ray);
  }
  return rays;
}

std::vector<TracedRay> trace_rays(Scene const& scene, double step, std::vector<Ray<double>> const& rays,
                                  Through through) {
  std::vector<TracedRay> traced(rays.size());
  TracingOptions<double> const options{step, scene.setup.medium.ambient_refractivity(), scene.setup.medium.integrator,
                                       scene.setup.medium.faces};
  std::visit(
      [&](auto const& medium) {
        parallel_chunks(rays.size(), 256, [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i) {
            throw_if_interrupted();
            traced[i] = trace_one(scene, options, medium, rays[i], through);
          }
        });
      },
      scene.medium.view);
  return traced;
}

std::string traced_rays_csv(std::vector<TracedRay> const& rays) {
  std::string text = "status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,col_px,row_px\n";
  for (TracedRay const& ray : rays) {
    Vec3d const p = ray.position / unit::millimetre;
    text += fmt::format("{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n",
                        to_string(ray.status), p.x, p.y, p.z, ray.direction.x, ray.direction.y, ray.direction.z,
                        ray.optical_path / unit::millimetre, ray.pixel.x, ray.pixel.y);
  }
  return text;
}

}  // namespace gladstone::inline cases
