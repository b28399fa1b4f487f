#include "render/optics/lens_stop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/optics/axial_beam.h"
#include "render/optics/paraxial.h"

namespace gladstone::inline optics {
namespace {

/// Returns the distance from the stop's axis at which a ray intersects the stop [m]; nullopt if the ray is lost.
std::optional<double> height_at_stop(Lens const& lens, Ray<double> ray) {
  RayAccount<double> account;
  int failed_at;
  RayStatus const status = lens.view().carry(ray, account, 0, lens.stop, failed_at);
  if (status != RayStatus::alive) return std::nullopt;
  Pose<double> const& stop = lens.poses[static_cast<std::size_t>(lens.stop)];
  Ray<double> local = stop.inwards(ray);
  double way = 0;
  bool const met = lens.surfaces[static_cast<std::size_t>(lens.stop)].visit(
      [&](auto const& surface) { return surface.shape.intersect(local, way); });
  if (!met) return std::nullopt;
  local.position = local.position + way * local.direction;
  return std::hypot(local.position.x, local.position.y);
}

/// Sets the stop radius for an entrance pupil of the given diameter [m].
void open_by_pupil(Lens& lens, double diameter) {
  double const radius = std::abs(diameter) / 2;
  if (!std::isfinite(radius)) {
    throw DataError(ErrorCode::undetermined, lens.prescription.file,
                    "an f-number does not define the aperture of an afocal lens; give the entrance pupil or the "
                    "stop's semi-diameter");
  }
  lens.paraxial_stop_radius = std::abs(ray_transfer(lens, 0, lens.stop).a) * radius;
  lens.stop_radius =
      height_at_stop(lens, {{radius, 0, -start_of_parallel_rays}, {0, 0, 1}}).value_or(lens.paraxial_stop_radius);
}

/// Sets the stop radius for a cone from the axial point at a distance [m], whose marginal ray has the given slope.
void open_by_slope(Lens& lens, double slope, double distance) {
  RayTransfer const to_stop = ray_transfer(lens, 0, lens.stop);
  lens.paraxial_stop_radius = std::abs(to_stop.a * distance + to_stop.b * lens.object_index) * slope;
  lens.stop_radius =
      height_at_stop(lens, {{0, 0, -distance}, normalized(Vec3d{slope, 0, 1})}).value_or(lens.paraxial_stop_radius);
}

/// Sets the stop radius for an image-side cone of the given working f-number.
void open_by_cone(Lens& lens, double f_number, double distance) {
  RayTransfer const all = ray_transfer(lens, 0, static_cast<int>(lens.paraxial.size()));
  double const slope = 1 / (2 * f_number * std::abs(all.c * distance + all.d * lens.object_index));
  if (!std::isfinite(distance) || !std::isfinite(slope)) {
    throw DataError(ErrorCode::undetermined, lens.prescription.file,
                    "an f-number does not define the aperture of a telecentric lens without an object distance; give "
                    "the file's object distance, or the stop's semi-diameter");
  }
  open_by_slope(lens, slope, distance);
}

/// Determines the radius of the stop by the aperture of the options, else by that of the prescription, else by the
/// semi-diameter of the stop surface.
void determine_stop_radius(Lens& lens, LensOptions const& options) {
  PrescribedAperture const& aperture = lens.prescription.aperture;
  using Kind = PrescribedAperture::Kind;
  PrescribedSurface const& stop = lens.prescription.surfaces[static_cast<std::size_t>(lens.stop)];
  bool const telecentric = is_telecentric(ray_transfer(lens, 0, lens.stop));
  double const prescribed = lens.prescription.object_distance;
  if (options.f_number && telecentric) {
    open_by_cone(lens, *options.f_number, options.object_distance.value_or(prescribed));
  } else if (options.f_number) {
    open_by_pupil(lens, paraxial_lens(lens).effective_focal_length / *options.f_number);
  } else if (aperture.kind == Kind::working_f_number && std::isfinite(prescribed)) {
    open_by_cone(lens, aperture.value, prescribed);
  } else if (aperture.kind == Kind::f_number || aperture.kind == Kind::working_f_number) {
    open_by_pupil(lens, paraxial_lens(lens).effective_focal_length / aperture.value);
  } else if (aperture.kind == Kind::entrance_pupil) {
    open_by_pupil(lens, aperture.value);
  } else if (aperture.kind == Kind::object_na && std::isfinite(prescribed)) {
    double const s = std::min(aperture.value, 1.0);
    open_by_slope(lens, s / std::sqrt(std::max(1 - s * s, 1e-12)), prescribed);
  } else if (std::isfinite(stop.semi_diameter)) {
    lens.stop_radius = lens.paraxial_stop_radius = stop.semi_diameter;
  } else {
    throw DataError(ErrorCode::missing_content, stop.where,
                    "the stop has no semi-diameter, and the file sets no aperture from which it follows; add its "
                    "semi-diameter (.zmx: DIAM, .seq: CIR, .toml: semi_diameter_mm), an entrance pupil or an f-number "
                    "(ENPD, FNUM; EPD, FNO; entrance_pupil_mm, f_number), or lens.f_number to the setup");
  }
}

/// Limits the opening required by the system aperture to the aperture on the stop surface itself.
void limit_by_own_aperture(Lens& lens, LensOptions const& options) {
  PrescribedSurface const& stop = lens.prescription.surfaces[static_cast<std::size_t>(lens.stop)];
  if (!stop.has_aperture) return;
  if (options.f_number && lens.paraxial_stop_radius > stop.semi_diameter) {
    lens.warnings.push_back(
        {WarningCode::inconsistent, stop.where,
         fmt::format("the aperture at the stop limits the lens to f/{:.4g}, which is used instead of f/{:.4g}; set "
                     "lens.f_number to a larger value, or enlarge this aperture",
                     *options.f_number * lens.paraxial_stop_radius / stop.semi_diameter, *options.f_number)});
  }
  lens.stop_radius = std::min(lens.stop_radius, stop.semi_diameter);
  lens.paraxial_stop_radius = std::min(lens.paraxial_stop_radius, stop.semi_diameter);
}

}  // namespace

void open_stop(Lens& lens, LensOptions const& options) {
  determine_stop_radius(lens, options);
  limit_by_own_aperture(lens, options);
  PrescribedSurface const& stop = lens.prescription.surfaces[static_cast<std::size_t>(lens.stop)];
  if (!(lens.stop_radius > 0) || !std::isfinite(lens.stop_radius)) {
    throw DataError(ErrorCode::invalid_value, stop.where,
                    "no light passes the stop (its radius is zero or infinite); correct the entrance pupil, the "
                    "f-number or the stop's semi-diameter");
  }
  auto& surface = lens.surfaces[static_cast<std::size_t>(lens.stop)];
  surface = surface.visit([&](auto opened) -> LensSurface<double> {
    opened.semi_diameter = lens.stop_radius;
    return opened;
  });
}

std::optional<double> prescribed_stop_radius(Lens lens, LensOptions options) {
  options.f_number.reset();
  try {
    open_stop(lens, options);
  } catch (DataError const&) {
    return std::nullopt;
  }
  return lens.paraxial_stop_radius;
}

void note_wide_stop(Lens& lens, double f_number, double own_radius, double object_distance) {
  constexpr double rounding = 1e-6;
  if (lens.paraxial_stop_radius <= (1 + rounding) * own_radius) return;
  std::string text = fmt::format("f/{:.4g} opens the stop wider than the prescription itself, which is f/{:.4g}",
                                 f_number, f_number * lens.paraxial_stop_radius / own_radius);
  if (auto const widest = max_axial_beam_radius(lens, object_distance)) {
    RayTransfer const to_stop = ray_transfer(lens, 0, lens.stop);
    double const asked = lens.paraxial_stop_radius / std::abs(to_stop.a + to_stop.b / object_distance);
    text += fmt::format(
        "; on the axis the lens passes f/{:.4g} at the widest, light outside this beam is lost at its edges",
        f_number * asked / *widest);
  } else {
    text += "; no edge of its surfaces limits that beam, for which the lens may not be designed: give semi-diameters";
  }
  lens.warnings.push_back({WarningCode::unsuitable, lens.prescription.file, text});
}

void open_rings(Lens& lens) {
  RayTransfer const to_stop = ray_transfer(lens, 0, lens.stop);
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    PrescribedSurface const& prescribed = lens.prescription.surfaces[i];
    if (!prescribed.obscured_without_end) continue;
    // height of a ray parallel to the axis at this surface, relative to that at the stop
    double const here = std::abs(ray_transfer(lens, 0, static_cast<int>(i)).a / to_stop.a);
    if (prescribed.obscured < here * lens.paraxial_stop_radius) continue;
    lens.surfaces[i] = lens.surfaces[i].visit([](auto opened) -> LensSurface<double> {
      opened.obscured = 0;
      return opened;
    });
    lens.warnings.push_back(
        {WarningCode::ignored, prescribed.where,
         fmt::format("this aperture admits light only beyond a radius of {:.6g} mm, which no light of the lens "
                     "reaches; it is ignored (if it should block light within the radius, give it an outer radius)",
                     prescribed.obscured / unit::millimetre)});
  }
}

}  // namespace gladstone::inline optics
