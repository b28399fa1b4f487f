#include <fmt/format.h>

#include <algorithm>

#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/scene/setup_checks.h"

namespace gladstone::inline scene {
namespace {

// relative error of the displacement that is tolerated if a given thickness truncates the field
constexpr double negligible_loss = 0.01;
// limit for "auto": 1e-4 px for a displacement of 1 px, as accurate as the truth
constexpr double noticeable_loss = 1e-4;

/// Returns half the width and height of the region of the medium that the dots' rays cross [m].
Vec2d half_extent_at_medium(Setup const& setup) {
  Vec2d const target = setup.target_extent();
  double const pupil = setup.imaging().entrance_pupil / 2;
  Vec2d half{};
  for (double const z : {-setup.medium.thickness / 2, setup.medium.thickness / 2}) {
    double const way = (setup.z_d + z) / setup.z_b();  // distance from the dots relative to that of the lens [1]
    half.x = std::max(half.x, target.x / 2 * (1 - way) + pupil * way);
    half.y = std::max(half.y, target.y / 2 * (1 - way) + pupil * way);
  }
  return half;
}

/// Density range of a field, for error messages.
struct FieldDensities {
  DensityRange range;
  char const* key;     ///< key that determines the range
  bool endless_range;  ///< the density is negative at some distance, whatever the field's strength
};

/// Returns the range of a closed-form field; for other fields, the ambient density.
FieldDensities field_densities(Setup const& setup) {
  double const ambient = setup.medium.ambient_density;
  if (setup.medium.field.kind != FieldKind::closed_form) return {{ambient, ambient}, "kind", false};
  return std::visit(
      [&setup](auto const& form) -> FieldDensities {
    return {form.densities(half_extent_at_medium(setup)), form.density_key, requires {form.endless_range; }
};
},
      make_closed_form(setup.medium));
}

/// Returns the key of the field's length scale.
/// @pre there is a field
std::string length_key(FieldSetup const& field) {
  if (field.kind == FieldKind::file) return field.spacing ? "spacing_mm" : "file";
  return std::visit([](auto const& form) { return std::string(form.length_key); }, field.form);
}

}  // namespace

void cross_check_thickness(Setup const& setup, Warnings& warnings) {
  MediumSetup const& slab = setup.medium;
  double const mm = unit::millimetre, lost = truncated_fraction(slab);
  bool const limited = slab.automatic_thickness && lost > noticeable_loss;
  if (limited || lost > negligible_loss) {
    warnings.push_back(
        {WarningCode::approximated, "medium.thickness_mm",
         fmt::format("{:.6g} mm{} cut {:.2g} % of the displacement off, since the field of {:.6g} mm radius extends "
                     "beyond them; {}",
                     slab.thickness / mm, limited ? ", all that fits between the dots and the lens," : "", 100 * lost,
                     radius_along_z(slab.field) / mm,
                     limited ? "increase geometry.z_d_mm or z_a_mm"
                             : fmt::format("use \"auto\", {:.6g} mm", automatic_thickness_mm(slab.field)))});
  }
}

void cross_check_density(Setup const& setup, SetupTable& medium, Warnings& warnings, std::string const& of_field) {
  double const K = setup.medium.gladstone_dale, ambient = setup.medium.ambient_density;
  if (!is_plausible_refractivity(K * ambient)) {
    medium.problem(
        "ambient_density_kg_m3",
        fmt::format(
            "gives a refractive index of {:.6g} (no medium has such an index); check it and medium.gladstone_dale",
            1 + K * ambient));
    return;
  }
  FieldDensities const densities = field_densities(setup);
  auto const [lowest, highest] = densities.range;
  char const* const key = densities.key;
  if (!is_plausible_refractivity(K * lowest) || !is_plausible_refractivity(K * highest)) {
    medium.tables(of_field).front().problem(
        key, fmt::format("gives refractive indices from {:.6g} to {:.6g} where rays cross the field (no medium has "
                         "such an index); check it and medium.gladstone_dale",
                         1 + K * lowest, 1 + K * highest));
  } else if (lowest >= 0) {
    return;
  } else if (densities.endless_range) {
    Vec2d const half = half_extent_at_medium(setup);
    warnings.push_back(
        {WarningCode::implausible, fmt::format("medium.{}.{}", of_field, key),
         fmt::format("the density is negative, {:.4g} kg/m^3 at the lowest, over a part of the {:.4g} x {:.4g} mm that "
                     "rays cross, which is impossible; reduce the gradient or increase medium.ambient_density_kg_m3",
                     lowest, 2 * half.x / unit::millimetre, 2 * half.y / unit::millimetre)});
  } else {
    medium.tables(of_field).front().problem(
        key,
        fmt::format("makes the density negative, {:.6g} kg/m^3 at the lowest (about medium.ambient_density_kg_m3 = "
                    "{:.6g}); reduce the amplitude or increase the ambient density",
                    lowest, ambient));
  }
}

void cross_check_steps(Setup const& setup, SetupTable medium, std::string const& of_field) {
  if (setup.medium.field.kind == FieldKind::none) return;
  double const thickness_mm = setup.medium.thickness / unit::millimetre;
  if (setup.medium.step_mm && thickness_mm > max_step_count * *setup.medium.step_mm) {
    medium.problem("step_mm", fmt::format("is so short that a ray would need {:.3g} steps across the medium ({:.0g} at "
                                          "most); use \"auto\" or a longer step",
                                          thickness_mm / *setup.medium.step_mm, max_step_count));
  }
  double steps = 0;
  try {
    steps = steps_across(setup.medium);
  } catch (DataError const&) {
    return;
  }
  if (steps <= max_step_count) return;
  std::string const key = length_key(setup.medium.field);
  medium.tables(of_field).front().problem(
      key, fmt::format("makes the field so fine that a ray would need {:.3g} steps across the medium ({:.0g} at most); "
                       "{}lengths are in mm",
                       steps, max_step_count, key == "file" ? "give medium.field.spacing_mm; " : "use a longer one; "));
}

}  // namespace gladstone::inline scene
