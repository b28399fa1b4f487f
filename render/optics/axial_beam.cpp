#include "render/optics/axial_beam.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "render/base/units.h"
#include "render/optics/apparent_pupil.h"

namespace gladstone::inline optics {
namespace {

constexpr double within_disc = 0.99;  // relative pupil radius within which rays pass the stop
constexpr int beam_heights = 16;      // number of ray heights
constexpr std::array<Vec2d, 4> beam_sides{Vec2d{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
constexpr double least_backwards = 1e-9;  // [m]; smaller distances are rounding errors at a sharp rim

/// Beam from the axial object point through the stop.
struct AxialBeam {
  RayOrigin origin;
  ApparentPupil disc;

  static std::optional<AxialBeam> of(Lens const& lens, double object_distance) {
    if (!(object_distance > 0)) return std::nullopt;
    RayOrigin const origin =
        std::isfinite(object_distance) ? RayOrigin::point({0, 0, -object_distance}) : RayOrigin::direction({0, 0, 1});
    auto const disc = find_apparent_pupil(lens, origin);
    if (!disc) return std::nullopt;
    return AxialBeam{origin, *disc};
  }
  Ray<double> at(double height, Vec2d side) const { return origin.ray_through(disc.at(height * side)); }
};

/// Returns a warning if a ray travels backwards through glass.
std::optional<Warning> warn_of_backward_ray(Lens const& lens, Ray<double> ray) {
  RayAccount<double> account;
  double begun = 0;  // optical path at the last surface that deflected the ray
  for (int i = 0; i < lens.view().count; ++i) {
    auto const at = static_cast<std::size_t>(i);
    double const height = std::hypot(ray.position.x, ray.position.y);
    int ignored;
    if (lens.view().carry(ray, account, i, i + 1, ignored) != RayStatus::alive) return std::nullopt;
    auto const [action, n] = lens.surfaces[at].visit([](auto const& s) { return std::pair{s.action, s.n_before}; });
    if (action == SurfaceAction::pass) continue;
    double const way = (account.optical_path - begun) / n;
    begun = account.optical_path;
    if (i == 0 || n == 1 || way > -least_backwards) continue;
    return Warning{
        WarningCode::inconsistent, lens.prescription.surfaces[at].where,
        fmt::format(
            "surface {}: the axial beam meets it {:.4g} mm ahead of the preceding face, at a height of {:.4g} mm: the "
            "faces cross within the beam, which is impossible; make the glass thicker, or the stop narrower",
            i + 1, -way / unit::millimetre, height / unit::millimetre)};
  }
  return std::nullopt;
}

}  // namespace

std::optional<Warning> crossed_faces(Lens const& lens, double object_distance) {
  auto const beam = AxialBeam::of(lens, object_distance);
  if (!beam) return std::nullopt;
  for (int k = 1; k <= beam_heights; ++k) {
    for (Vec2d const side : beam_sides) {
      if (auto const told = warn_of_backward_ray(lens, beam->at(k * within_disc / beam_heights, side))) return told;
    }
  }
  return std::nullopt;
}

std::optional<double> max_axial_beam_radius(Lens const& lens, double object_distance) {
  auto const beam = AxialBeam::of(lens, object_distance);
  if (!beam) return std::nullopt;
  auto const passes = [&](double height) {
    for (Vec2d const side : beam_sides) {
      Ray<double> ray = beam->at(height, side);
      RayAccount<double> account;
      if (lens.view().carry(ray, account) != RayStatus::alive) return false;
    }
    return true;
  };
  double free = passes(within_disc) ? within_disc : 0, taken = within_disc;
  for (int halving = 0; halving < 40 && free < within_disc; ++halving) {
    double const tried = (free + taken) / 2;
    (passes(tried) ? free : taken) = tried;
  }
  auto const place = intersect_stop(lens, beam->at(free, beam_sides[0]));
  constexpr double whole = 0.97;  // relative height in the stop that the rim ray reaches if it is not vignetted
  if (free == within_disc && place && length(*place) > whole * lens.stop_radius) return std::nullopt;
  return length(free * beam->disc.a);
}

}  // namespace gladstone::inline optics
