#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/analytic_fields.h"
#include "render/medium/field_volume.h"
#include "render/scene/setup_checks.h"

namespace gladstone {
namespace {

constexpr double negligible_loss = 0.01;  // of a field's displacement, cut off by a thickness that the user chose
constexpr double noticeable_loss = 1e-4;  // cut off where the user chose none: 1e-4 px in a pixel, as truth is good to

/// Half width and height of what dots' rays cross of the medium [m].
Vec2d half_extent_at_medium(Setup const& setup) {
  Vec2d const target = setup.target_extent();
  double const pupil = setup.imaging().entrance_pupil / 2;
  Vec2d half{};
  for (double const z : {-setup.medium.thickness / 2, setup.medium.thickness / 2}) {
    double const way = (setup.z_d + z) / setup.z_b();  // from the dots to the lens
    half.x = std::max(half.x, target.x / 2 * (1 - way) + pupil * way);
    half.y = std::max(half.y, target.y / 2 * (1 - way) + pupil * way);
  }
  return half;
}

/// Densities that a field takes where rays cross it [kg/m^3].
struct DensityRange {
  double lowest, highest;
};

/// Of a field in closed form, or of the ambient where there is none.
DensityRange density_range(Setup const& setup) {
  FieldSetup const& field = setup.medium.field;
  double const ambient = setup.medium.ambient_density;
  switch (field.kind) {
    case FieldKind::sinusoid:
      return {ambient - std::abs(field.amplitude), ambient + std::abs(field.amplitude)};
    case FieldKind::gaussian_plume:
    case FieldKind::gaussian_blob:
      return {ambient + std::min(field.amplitude, 0.0), ambient + std::max(field.amplitude, 0.0)};
    case FieldKind::uniform_gradient: {
      Vec2d const half = half_extent_at_medium(setup);
      double const change = std::abs(field.gradient.x) * half.x + std::abs(field.gradient.y) * half.y +
                            std::abs(field.gradient.z) * setup.medium.thickness / 2;
      return {ambient - change, ambient + change};
    }
    case FieldKind::normal_shock:
      return {field.upstream_density, field.upstream_density * shock_density_ratio(field.mach, constant::gamma_air)};
    case FieldKind::none:
    case FieldKind::file:
      break;
  }
  return {ambient, ambient};
}

/// The key that a closed form's densities follow from.
char const* density_key(FieldKind kind) {
  switch (kind) {
    case FieldKind::uniform_gradient:
      return "gradient_kg_m4";
    case FieldKind::normal_shock:
      return "upstream_density_kg_m3";
    default:
      return "amplitude_kg_m3";
  }
}

/// The key of the length on which a field changes.
std::string length_key(FieldSetup const& field) {
  switch (field.kind) {
    case FieldKind::sinusoid:
      return "wavelength_mm";
    case FieldKind::gaussian_plume:
    case FieldKind::gaussian_blob:
      return "radius_mm";
    case FieldKind::normal_shock:
      return "shock_thickness_mm";
    case FieldKind::file:
      return field.spacing ? "spacing_mm" : "file";
    case FieldKind::none:
    case FieldKind::uniform_gradient:
      break;
  }
  return "kind";
}

}  // namespace

void cross_check_thickness(Setup const& setup, SetupTable medium, std::vector<std::string>& warnings) {
  MediumSetup const& slab = setup.medium;
  double const mm = unit::millimetre, lost = cut_off_share(slab);
  bool const limited = slab.automatic_thickness && lost > noticeable_loss;
  if (limited || lost > negligible_loss) {
    warnings.push_back(fmt::format(
        "medium.thickness_mm: {:.6g} mm{} cut {:.2g} % of the displacement off, since the field of {:.6g} mm radius "
        "goes on beyond them; {}",
        slab.thickness / mm, limited ? ", all that fits between the dots and the lens," : "", 100 * lost,
        slab.field.radius / mm,
        limited ? "increase geometry.z_d_mm or z_a_mm"
                : fmt::format("use \"auto\", {:.6g} mm", automatic_thickness_mm(slab.field))));
  }
  if (slab.field.kind != FieldKind::file || slab.field.extrude) return;
  double depth = 0;
  try {
    Bounds<double> const box = file_bounds(slab);
    depth = box.high.z - box.low.z;
  } catch (DataError const&) {
    return;  // left to those who read it
  }
  if (!slab.automatic_thickness && std::abs(slab.thickness - depth) > 1e-6 * depth) {
    warnings.push_back(
        fmt::format("medium.thickness_mm: {:.6g} mm is not used, since a volume has its own depth, {:.6g} "
                    "mm; leave it out, or give medium.field.spacing_mm",
                    slab.thickness / mm, depth / mm));
  }
  medium.resolve("thickness_mm", depth / mm);
}

void cross_check_density(Setup const& setup, SetupTable medium, std::vector<std::string>& warnings,
                         std::string const& of_field) {
  FieldSetup const& field = setup.medium.field;
  double const K = setup.medium.gladstone_dale, ambient = setup.medium.ambient_density;
  if (!possible_refractivity(K * ambient)) {
    medium.problem(
        "ambient_density_kg_m3",
        fmt::format("gives a refractive index of {:.6g} (no such medium); check it and medium.gladstone_dale",
                    1 + K * ambient));
    return;
  }
  auto const [lowest, highest] = density_range(setup);
  char const* const key = density_key(field.kind);
  if (!possible_refractivity(K * lowest) || !possible_refractivity(K * highest)) {
    medium.tables(of_field).front().problem(
        key, fmt::format("gives refractive indices from {:.6g} to {:.6g} where rays cross the field (no such medium); "
                         "check it and medium.gladstone_dale",
                         1 + K * lowest, 1 + K * highest));
  } else if (lowest >= 0) {
    return;
  } else if (field.kind == FieldKind::uniform_gradient) {
    Vec2d const half = half_extent_at_medium(setup);
    warnings.push_back(
        fmt::format("medium.{}.gradient_kg_m4: the density is negative, {:.4g} kg/m^3 at the lowest, over a part of "
                    "the {:.4g} x {:.4g} mm that rays cross (no gas has that); reduce the gradient or increase "
                    "medium.ambient_density_kg_m3",
                    of_field, lowest, 2 * half.x / unit::millimetre, 2 * half.y / unit::millimetre));
  } else {
    medium.tables(of_field).front().problem(
        key,
        fmt::format("makes the density negative, {:.6g} kg/m^3 at the lowest (about medium.ambient_density_kg_m3 = "
                    "{:.6g}); reduce the amplitude or increase the ambient density",
                    lowest, ambient));
  }
}

void cross_check_steps(Setup const& setup, SetupTable medium, std::string const& of_field) {
  FieldKind const kind = setup.medium.field.kind;
  if (kind == FieldKind::none) return;
  double const thickness_mm = setup.medium.thickness / unit::millimetre;
  if (setup.medium.step_mm && thickness_mm > most_steps * *setup.medium.step_mm) {
    medium.problem("step_mm", fmt::format("is so short that a ray would need {:.3g} steps across the medium ({:.0g} at "
                                          "most); use \"auto\" or a longer step",
                                          thickness_mm / *setup.medium.step_mm, most_steps));
  }
  double steps = 0;
  try {
    steps = steps_across(setup.medium);
  } catch (DataError const&) {
    return;
  }
  if (steps <= most_steps) return;
  std::string const key = length_key(setup.medium.field);
  medium.tables(of_field).front().problem(
      key, fmt::format("makes the field so fine that a ray would need {:.3g} steps across the medium ({:.0g} at most); "
                       "{}lengths are in mm",
                       steps, most_steps, key == "file" ? "give medium.field.spacing_mm; " : "use a longer one; "));
}

}  // namespace gladstone
