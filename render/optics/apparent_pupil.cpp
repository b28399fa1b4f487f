#include "render/optics/apparent_pupil.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/units.h"
#include "render/optics/paraxial.h"
#include "render/optics/trace_back.h"

namespace gladstone::inline optics {
namespace {

constexpr double near_enough = 1e-3;  // accuracy of the rim points, relative to the stop's radius; the margin is wider
constexpr double ahead = 1;           // start of parallel rays, ahead of the first vertex [m]

/// Returns a full Newton step; nullopt if a neighbouring ray is lost or the Jacobian is singular.
std::optional<Vec2d> newton_step(StopMapping const& sight, Vec2d p, Vec2d miss) {
  auto const right = sight.place(p + Vec2d{sight.step, 0}), left = sight.place(p - Vec2d{sight.step, 0});
  auto const up = sight.place(p + Vec2d{0, sight.step}), down = sight.place(p - Vec2d{0, sight.step});
  if (!right || !left || !up || !down) return std::nullopt;
  Vec2d const dx = (*right - *left) / (2 * sight.step), dy = (*up - *down) / (2 * sight.step);
  double const determinant = dx.x * dy.y - dx.y * dy.x;
  if (determinant == 0) return std::nullopt;
  return Vec2d{(miss.x * dy.y - miss.y * dy.x) / determinant, (dx.x * miss.y - dx.y * miss.x) / determinant};
}

/// Returns the intersection of the paraxial chief ray with the aim plane [m].
Vec2d paraxial_guess(Lens const& lens, RayOrigin const& origin) {
  RayTransfer const m = ray_transfer(lens, 0, lens.stop);
  // solve a y + b u = 0, with u = (y - y0) / distance for a point source, or u given for parallel rays
  if (origin.at_infinity) {
    if (m.a == 0) return {};
    Vec2d const slope{origin.place.x / origin.place.z, origin.place.y / origin.place.z};
    return (-m.b / m.a) * slope;
  }
  double const distance = -origin.place.z, under = m.a * distance + m.b;
  if (under == 0) return {};
  return (m.b / under) * Vec2d{origin.place.x, origin.place.y};
}

/// Returns the angles (x, y) between a direction, reversed if necessary to point in +z direction, and the axis [rad].
Vec2d direction_angles(Vec3d direction) {
  Vec2d const across = direction.z < 0 ? Vec2d{-direction.x, -direction.y} : Vec2d{direction.x, direction.y};
  double const sine = length(across);
  return sine > 0 ? std::atan2(sine, std::abs(direction.z)) / sine * across : Vec2d{};
}

/// Returns the intersection of a line with the aim plane [m]; nullopt if they are almost parallel.
std::optional<Vec2d> aim_of_line(Ray<double> const& line) {
  constexpr double grazing = 1e-6;
  if (std::abs(line.direction.z) < grazing) return std::nullopt;
  double const way = -line.position.z / line.direction.z;
  return Vec2d{line.position.x + way * line.direction.x, line.position.y + way * line.direction.y};
}

/// Determines the chief ray's point on the aim plane by backward tracing: Newton's method for the slope in the stop
/// whose line ahead of the lens passes through the source. The residual is an angle, which remains nearly linear in the
/// slope for wide fields.
std::optional<Vec2d> aim_from_stop(StopMapping const& sight) {
  if (!sight.trace_back) return std::nullopt;
  StopMapping back;
  back.radius = 1;   // scale of the tolerance of the residual [rad]
  back.step = 1e-6;  // step of the finite differences of the slope [1]
  back.place = [&](Vec2d slope) -> std::optional<Vec2d> {
    auto const line = sight.trace_back(slope);
    auto const aim = line ? aim_of_line(*line) : std::nullopt;
    if (!aim) return std::nullopt;
    return direction_angles(line->direction) - direction_angles(sight.origin.ray_through(*aim).direction);
  };
  Vec2d slope{};
  if (!aim_at(back, {}, slope)) return std::nullopt;
  auto const line = sight.trace_back(slope);
  return line ? aim_of_line(*line) : std::nullopt;
}

}  // namespace

Ray<double> RayOrigin::ray_through(Vec2d p) const {
  Vec3d const on_plane{p.x, p.y, 0};
  if (!at_infinity) return {place, normalized(on_plane - place)};
  return {on_plane - ahead * place, place};
}

std::optional<Vec2d> intersect_stop(Lens const& lens, Ray<double> ray) {
  RayAccount<double> account;
  int failed_at;
  RayStatus const status = lens.view().carry(ray, account, 0, lens.stop, failed_at);
  if (status != RayStatus::alive && status != RayStatus::vignetted) return std::nullopt;
  auto const stop = static_cast<std::size_t>(lens.stop);
  Ray<double> const local = lens.poses[stop].inwards(ray);
  double way = 0;
  bool const met = lens.surfaces[stop].visit([&](auto const& surface) { return surface.shape.intersect(local, way); });
  if (!met) return std::nullopt;
  return Vec2d{local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
}

bool aim_at(StopMapping const& sight, Vec2d target, Vec2d& aim, double tolerance) {
  auto here = sight.place(aim);
  if (!here) return false;
  for (int iteration = 0; iteration < 40; ++iteration) {
    Vec2d const miss = target - *here;
    if (length(miss) < tolerance * sight.radius) return true;
    auto const change = newton_step(sight, aim, miss);
    if (!change) return false;
    // halve the step repeatedly if it loses the ray or does not reduce the residual
    bool better = false;
    for (double share = 1; share > 1e-3 && !better; share /= 2) {
      Vec2d const tried = aim + share * *change;
      auto const there = sight.place(tried);
      if (!there || length(target - *there) >= length(miss)) continue;
      aim = tried;
      here = there;
      better = true;
    }
    if (!better) return length(miss) < 1e3 * tolerance * sight.radius;
  }
  return false;
}

std::optional<Vec2d> find_chief_aim(StopMapping const& sight, Vec2d guess) {
  for (Vec2d aim : {guess, Vec2d{}}) {
    if (aim_at(sight, {}, aim)) return aim;
  }
  auto aim = aim_from_stop(sight);
  if (!aim || !aim_at(sight, {}, *aim)) return std::nullopt;
  return aim;
}

double ellipse_safety_factor(int rim_points) {
  // Between rim points, the footprint may exceed the ellipse by 1 - cos(pi / points) of its deviation from the ellipse,
  // which is assumed to be at most 10 %. The first term covers the accuracy of the points.
  return 1 + 2 * near_enough + 0.1 * (1 - std::cos(pi / rim_points));
}

std::optional<ApparentPupil> find_apparent_pupil(StopMapping const& sight, Vec2d guess, int rim_points) {
  ApparentPupil disc;
  auto const chief = find_chief_aim(sight, guess);
  if (!chief) return std::nullopt;
  disc.centre = *chief;
  // initial guess of the rim points for a stop imaged without aberration
  std::optional<Vec2d> const along_x = newton_step(sight, disc.centre, {sight.radius, 0});
  std::optional<Vec2d> const along_y = newton_step(sight, disc.centre, {0, sight.radius});
  std::vector<Vec2d> rim;
  for (int k = 0; k < rim_points; ++k) {
    double const angle = 2 * pi * k / rim_points;
    Vec2d const towards{std::cos(angle), std::sin(angle)};
    Vec2d const linear = along_x && along_y ? towards.x * *along_x + towards.y * *along_y : Vec2d{};
    Vec2d p = disc.centre;
    // aim at the rim, or closer to the centre if those rays are lost in the lens and hence do not reach the stop
    for (double const share : {1.0, 0.9, 0.75, 0.5}) {
      p = disc.centre + share * linear;
      if (aim_at(sight, share * sight.radius * towards, p, near_enough)) break;
      p = disc.centre;
      if (aim_at(sight, share * sight.radius * towards, p, near_enough)) break;
      p = disc.centre;
    }
    rim.push_back(p);
  }
  // fit the ellipse's axes by a discrete Fourier transform over the rim, then enlarge it to contain the furthest point
  for (int k = 0; k < rim_points; ++k) {
    double const angle = 2 * pi * k / rim_points;
    disc.a += (2.0 / rim_points) * std::cos(angle) * (rim[static_cast<std::size_t>(k)] - disc.centre);
    disc.b += (2.0 / rim_points) * std::sin(angle) * (rim[static_cast<std::size_t>(k)] - disc.centre);
  }
  double const determinant = disc.a.x * disc.b.y - disc.a.y * disc.b.x;
  if (determinant == 0) return std::nullopt;
  double furthest = 1;
  for (Vec2d const p : rim) {
    Vec2d const d = p - disc.centre;
    double const u = (d.x * disc.b.y - d.y * disc.b.x) / determinant;
    double const v = (disc.a.x * d.y - disc.a.y * d.x) / determinant;
    furthest = std::max(furthest, std::hypot(u, v));
  }
  double const margin = ellipse_safety_factor(rim_points);
  disc.a = margin * furthest * disc.a;
  disc.b = margin * furthest * disc.b;
  return disc;
}

std::optional<ApparentPupil> find_apparent_pupil(Lens const& lens, RayOrigin const& origin) {
  double const scale = std::abs(ray_transfer(lens, 0, lens.stop).a);
  StopMapping const sight{[&](Vec2d p) { return intersect_stop(lens, origin.ray_through(p)); }, lens.stop_radius,
                          1e-4 * lens.stop_radius / std::max(scale, 0.05), origin,
                          [&](Vec2d slope) { return trace_back_from_stop(lens.surfaces, lens.stop, slope); }};
  constexpr int rim_points = 32;
  return find_apparent_pupil(sight, paraxial_guess(lens, origin), rim_points);
}

}  // namespace gladstone::inline optics
