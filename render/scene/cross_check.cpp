#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/setup.h"
#include "render/scene/setup_checks.h"
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
