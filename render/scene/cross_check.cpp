#include "render/scene/cross_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/scene/build_camera.h"
#include "render/scene/cross_check_places.h"
#include "render/scene/read_setup.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline scene {
namespace {

constexpr double widest_spot_px = 200;   // maximum diameter between first zeros [px]; f/64 gives about 10 px
constexpr double widest_airy_px = 60;    // the table needs 0.2 GB at this size
constexpr double finest_pitch = 0.5e-6;  // no camera has smaller pixels [m]
constexpr double fastest_lens = 0.5;     // f-number at which an aplanatic lens in air accepts a half space

/// Builds the camera to check that it forms an image of the dots.
bool cross_check_camera(Setup const& setup, SetupTable root) {
  try {
    build_camera(setup);
    setup.target_extent();
    return true;
  } catch (DataError const& error) {
    if (error.key() == "lens") {
      root.table("lens").problem(setup.lens.prescription ? "file" : "focus", error.message(), error.code());
    } else {
      camera_table(root).problem("pose", error.message(), error.code());
    }
  }
  return false;
}

/// Checks that lens and camera form an image of the dots.
bool cross_check_lens(Setup const& setup, SetupTable root, Warnings& warnings) {
  double const mm = unit::millimetre;
  SetupTable lens = root.table("lens"), geometry = root.table("geometry");
  if (setup.lens.f_number < fastest_lens) {
    lens.problem(
        "f_number",
        fmt::format("is below {} (in air, the aperture of a lens is at most twice its focal length); increase it",
                    fastest_lens));
    return false;
  }
  if (!setup.lens.prescription && setup.focus_distance() <= setup.lens.focal_length) {
    bool const by_distance = setup.lens.focus == Focus::distance;
    (by_distance ? lens : geometry)
        .problem(by_distance ? "focus_distance_mm" : "z_a_mm",
                 fmt::format(
                     "focus is impossible: the plane in focus lies {:.6g} mm from a lens of {:.6g} mm focal length "
                     "(the distance must exceed the focal length); move the lens away or use a shorter focal length{}",
                     setup.focus_distance() / mm, setup.lens.focal_length / mm, metres_hint(setup.focus_distance())));
    return false;
  }
  if (!setup.lens.prescription && setup.z_b() <= setup.lens.focal_length) {
    geometry.problem("z_a_mm",
                     "the dots lie within the focal length, where they have no real image; move the lens away");
    return false;
  }
  if (!cross_check_camera(setup, root)) return false;
  for (OpticalElement const& element : setup.elements) {
    if (auto const warning = element.imaging_warning(setup.imaging(), setup.lens.f_number))
      warnings.push_back(*warning);
  }
  return true;
}

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

/// Warns if the thickness of the medium truncates a field that is still significant there.
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

/// Reports closed-form fields with impossible refractive indices, and negative densities.
/// A uniform gradient reaches negative densities at some distance whatever its strength: inside the view this is only a
/// warning.
/// @param of_field  key of the field's table: "field", or "second_field" if `setup` contains the second field in its
///   place
void cross_check_density(Setup const& setup, SetupTable& medium, Warnings& warnings,
                         std::string const& of_field = "field") {
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

/// Reports steps, or length scales of the field, that would require more than `max_step_count` integration steps across
/// the medium. A file that cannot be read is ignored; its reader reports it.
void cross_check_steps(Setup const& setup, SetupTable medium, std::string const& of_field = "field") {
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

}  // namespace

std::string metres_hint(double length) {
  double const millimetres = length / unit::millimetre;
  if (!(millimetres < 2)) return "";
  return fmt::format(" (lengths are in mm: {0:.6g} mm was given, {0:.6g} m are {1:.6g} mm)", millimetres,
                     1e3 * millimetres);
}

void cross_check_noise(Setup const& setup, Warnings& warnings) {
  if (double const clipped = clipped_at_black(setup.camera); clipped > 0.05) {
    NoiseSetup const& noise = setup.camera.noise;
    double const levels = noise.read_noise_e * (std::pow(2.0, setup.camera.bit_depth) - 1) / noise.full_well_e;
    warnings.push_back(
        {WarningCode::unsuitable, "camera.offset_dn",
         fmt::format(
             "the read noise of {:.3g} grey levels is clipped at zero, which makes dark pixels {:.3g} levels too "
             "bright on average and dim ones less; set camera.offset_dn to {:.0f} or more, as real cameras do",
             levels, clipped, std::ceil(4 * levels))});
  }
}

void cross_check_spot(Setup const& setup, SetupTable root) {
  double const diffraction_px = setup.spot_diameter_px();
  double const widest_px = setup.lens.spot == SpotModel::airy ? widest_airy_px : widest_spot_px;
  if (diffraction_px > widest_px && setup.camera.pixel_pitch < finest_pitch) {
    camera_table(root).problem("pixel_pitch_um",
                               fmt::format("makes the diffraction spot {:.4g} px wide ({} px at most, or nothing is "
                                           "resolved); pitches are in um, and camera pixels are 1 to 20 um wide",
                                           diffraction_px, widest_px));
  } else if (diffraction_px > widest_px) {
    root.table("lens").problem("f_number",
                               fmt::format("the diffraction spot would be {:.4g} px wide ({} px at most, or nothing is "
                                           "resolved); open the lens or focus farther away",
                                           diffraction_px, widest_px));
  }
}

void cross_check_medium(Setup const& setup, SetupTable root, Warnings& warnings) {
  SetupTable medium = root.table("medium");
  cross_check_geometry(setup, root.table("geometry"));
  cross_check_elements(setup, root);
  cross_check_thickness(setup, warnings);
  cross_check_noise(setup, warnings);
  cross_check_steps(setup, medium);
  cross_check_density(setup, medium, warnings);
  if (!setup.medium.second_field) return;
  Setup second = setup;
  second.medium = select_second_pulse(setup.medium);
  cross_check_geometry(second, root.table("geometry"));
  cross_check_steps(second, medium, "second_field");
  cross_check_density(second, medium, warnings, "second_field");
}

Warnings cross_check(Setup const& setup, SetupTable root) {
  Warnings warnings = setup.warnings;
  // all other checks require an image
  if (cross_check_lens(setup, root, warnings)) setup.experiment().cross_check(setup, std::move(root), warnings);
  return warnings;
}

}  // namespace gladstone::inline scene
