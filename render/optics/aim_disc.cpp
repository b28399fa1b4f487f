#include "render/optics/aim_disc.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "render/optics/paraxial.h"

namespace gladstone {
namespace {

constexpr double ahead = 1;  // where parallel rays begin, in front of the first vertex [m]

/// Solves place_in_stop(origin.ray_through(p)) = target for p by Newton's method with differences.
class StopAim {
 public:
  StopAim(Lens const& lens, RayOrigin const& origin) : lens_(lens), origin_(origin) {
    double const scale = std::abs(ray_transfer(lens, 0, lens.stop).a);
    step_ = 1e-4 * lens.stop_radius / std::max(scale, 0.05);
  }

  std::optional<Vec2d> place(Vec2d p) const { return place_in_stop(lens_, origin_.ray_through(p)); }

  /// @param p the first guess; becomes the solution
  bool solve(Vec2d target, Vec2d& p) const {
    auto here = place(p);
    if (!here) return false;
    for (int iteration = 0; iteration < 40; ++iteration) {
      Vec2d const miss = target - *here;
      if (length(miss) < 1e-10 * lens_.stop_radius) return true;
      auto const change = newton_step(p, miss);
      if (!change) return false;
      // half a step, and half of that, where the whole one loses the ray or gains nothing
      bool better = false;
      for (double share = 1; share > 1e-3 && !better; share /= 2) {
        Vec2d const tried = p + share * *change;
        auto const there = place(tried);
        if (!there || length(target - *there) >= length(miss)) continue;
        p = tried;
        here = there;
        better = true;
      }
      if (!better) return length(miss) < 1e-7 * lens_.stop_radius;
    }
    return false;
  }

 private:
  std::optional<Vec2d> newton_step(Vec2d p, Vec2d miss) const {
    auto const right = place(p + Vec2d{step_, 0}), left = place(p - Vec2d{step_, 0});
    auto const up = place(p + Vec2d{0, step_}), down = place(p - Vec2d{0, step_});
    if (!right || !left || !up || !down) return std::nullopt;
    Vec2d const dx = (*right - *left) / (2 * step_), dy = (*up - *down) / (2 * step_);
    double const determinant = dx.x * dy.y - dx.y * dy.x;
    if (determinant == 0) return std::nullopt;
    return Vec2d{(miss.x * dy.y - miss.y * dy.x) / determinant, (dx.x * miss.y - dx.y * miss.x) / determinant};
  }

  Lens const& lens_;
  RayOrigin const& origin_;
  double step_;
};

/// Where the paraxial chief ray passes the tangent plane of the first vertex.
Vec2d paraxial_guess(Lens const& lens, RayOrigin const& origin) {
  RayTransfer const m = ray_transfer(lens, 0, lens.stop);
  // a y + b u = 0 with u = (y - y0) / distance from a point, or u given
  if (origin.at_infinity) {
    if (m.a == 0) return {};
    Vec2d const slope{origin.place.x / origin.place.z, origin.place.y / origin.place.z};
    return (-m.b / m.a) * slope;
  }
  double const distance = -origin.place.z, under = m.a * distance + m.b;
  if (under == 0) return {};
  return (m.b / under) * Vec2d{origin.place.x, origin.place.y};
}

}  // namespace

Ray<double> RayOrigin::ray_through(Vec2d p) const {
  Vec3d const on_plane{p.x, p.y, 0};
  if (!at_infinity) return {place, normalized(on_plane - place)};
  return {on_plane - ahead * place, place};
}

double AimDisc::area() const { return pi * std::abs(a.x * b.y - a.y * b.x); }

std::optional<Vec2d> place_in_stop(Lens const& lens, Ray<double> ray) {
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

std::optional<AimDisc> find_aim_disc(Lens const& lens, RayOrigin const& origin) {
  StopAim const aim(lens, origin);
  AimDisc disc;
  disc.centre = paraxial_guess(lens, origin);
  if (!aim.solve({}, disc.centre)) {
    disc.centre = {};
    if (!aim.solve({}, disc.centre)) return std::nullopt;
  }
  constexpr int rim_points = 32;
  std::vector<Vec2d> rim;
  Vec2d from = disc.centre;
  for (int k = 0; k < rim_points; ++k) {
    double const angle = 2 * pi * k / rim_points;
    Vec2d const target = lens.stop_radius * Vec2d{std::cos(angle), std::sin(angle)};
    Vec2d p = from;
    // towards the rim as far as rays can be followed: what lies beyond is lost in the lens and passes no stop
    for (double const share : {1.0, 0.9, 0.75, 0.5}) {
      p = from;
      if (aim.solve(share * target, p)) break;
      p = disc.centre;
    }
    rim.push_back(p);
  }
  // the ellipse's axes by Fourier's sums over the rim, then as much wider as its furthest point asks for
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
  constexpr double margin = 1.005;  // the rim between its 32 points: (1 - cos(pi / 32)) of it
  disc.a = margin * furthest * disc.a;
  disc.b = margin * furthest * disc.b;
  return disc;
}

}  // namespace gladstone
