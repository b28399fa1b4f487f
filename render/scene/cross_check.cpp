#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/calibration_planes.h"
#include "render/scene/particle_scene.h"
#include "render/scene/setup.h"
#include "render/scene/setup_checks.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone {
namespace {

constexpr double widest_spot_px = 200;   // between first zeros [px]; f/64 gives about 10 px
constexpr double widest_airy_px = 60;    // the table needs 0.2 GB at this size
constexpr double finest_pitch = 0.5e-6;  // no camera has smaller pixels [m]
constexpr double fastest_lens = 0.5;     // f-number at which an aplanatic lens in air accepts a half space

/// Builds a camera without closed form to check that it forms an image of the dots.
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

/// Reports views and targets that extend farther off the axis than a lens can image: no chief rays are found from
/// there.
void cross_check_extents(Setup const& setup, Vec2d view, SetupTable target, SetupTable root) {
  double const widest = 2 * setup.max_off_axis_distance(), mm = unit::millimetre;
  if (std::max(view.x, view.y) > widest) {
    camera_table(root).problem(
        "pixel_pitch_um",
        fmt::format("makes a field of view of {:.4g} x {:.4g} mm (at most {:.4g} mm, 168 degrees, are supported); "
                    "pitches are in um; use a longer focal length or fewer or smaller pixels",
                    view.x / mm, view.y / mm, widest / mm));
  } else if (setup.target.extent_m && std::max(setup.target.extent_m->x, setup.target.extent_m->y) > widest) {
    target.problem("extent_mm",
                   fmt::format("exceeds the largest supported field of view, 168 degrees ({:.4g} mm, ten times the "
                               "distance to the lens on each side); use the view or a little more",
                               widest / mm));
  }
}

/// Warns of read noise that is clipped at zero.
void cross_check_noise(Setup const& setup, std::vector<std::string>& warnings) {
  if (double const clipped = clipped_at_black(setup.camera); clipped > 0.05) {
    NoiseSetup const& noise = setup.camera.noise;
    double const levels = noise.read_noise_e * (std::pow(2.0, setup.camera.bit_depth) - 1) / noise.full_well_e;
    warnings.push_back(fmt::format(
        "camera.offset_dn: the read noise of {:.3g} grey levels is clipped at zero, which makes dark pixels {:.3g} "
        "levels too bright on average and dim ones less; set camera.offset_dn to {:.0f} or more, as real cameras do",
        levels, clipped, std::ceil(4 * levels)));
  }
}

/// Checks that lens and camera form an image of the dots.
bool cross_check_lens(Setup const& setup, SetupTable root, std::vector<std::string>& warnings) {
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
  if (!setup.has_closed_form_layout() && !cross_check_camera(setup, root)) return false;
  for (OpticalElement const& element : setup.elements) {
    std::string warning = element.imaging_warning(setup.imaging(), setup.lens.f_number);
    if (!warning.empty()) warnings.push_back(std::move(warning));
  }
  return true;
}

/// Reports diffraction PSFs that are too wide to resolve anything.
void cross_check_spot(Setup const& setup, double diffraction_px, SetupTable lens, SetupTable root) {
  double const widest_px = setup.lens.spot == SpotModel::airy ? widest_airy_px : widest_spot_px;
  if (diffraction_px > widest_px && setup.camera.pixel_pitch < finest_pitch) {
    camera_table(root).problem("pixel_pitch_um",
                               fmt::format("makes the diffraction spot {:.4g} px wide ({} px at most, or nothing is "
                                           "resolved); pitches are in um, and camera pixels are 1 to 20 um wide",
                                           diffraction_px, widest_px));
  } else if (diffraction_px > widest_px) {
    lens.problem("f_number", fmt::format("the diffraction spot would be {:.4g} px wide ({} px at most, or nothing is "
                                         "resolved); open the lens or focus farther away",
                                         diffraction_px, widest_px));
  }
}

/// Checks the target's size and the size and polarity of its dots.
void cross_check_target(Setup const& setup, SetupTable root) {
  double const mm = unit::millimetre;
  SetupTable lens = root.table("lens"), target = root.table("target");
  double const px = setup.pixel_size();
  Vec2d view{setup.camera.columns * px, setup.camera.rows * px}, needed = view + setup.target_view_margin();
  if (setup.has_oblique_view()) needed = view = posed_view(setup);
  if (setup.target.extent_m && (setup.target.extent_m->x < needed.x || setup.target.extent_m->y < needed.y)) {
    target.problem("extent_mm", fmt::format("the field of view, {:.4g} x {:.4g} mm at the dots, is larger than the "
                                            "target or partly outside of it ({:.4g} x {:.4g} mm about its centre would "
                                            "contain the whole view); enlarge the target or leave extent_mm out",
                                            view.x / mm, view.y / mm, needed.x / mm, needed.y / mm));
  }
  cross_check_extents(setup, view, target, root);
  if (setup.target.kind != TargetKind::image) {
    double const diameter_px = setup.geometric_dot_px();
    cross_check_spot(setup, setup.spot_diameter_px(), lens, root);
    if (setup.target.polarity == Polarity::dark && diameter_px == 0) {
      target.problem("polarity", "dark dots of zero size cannot be seen; give dot_diameter_px");
    }
    if (setup.target.polarity == Polarity::dark && setup.divides_light()) {
      target.problem("polarity",
                     "dark dots on white paper cannot be rendered through lenslets (the light of the paper through "
                     "each of them is unknown); use bright dots");
    }
  }
}

/// Checks the number of random or regular dots.
void cross_check_dot_count(Setup const& setup, SetupTable target) {
  double const mm = unit::millimetre;
  double const count = setup.dot_count();
  double const diameter = setup.dot_diameter();
  Vec2d const extent = setup.target_extent();
  double const coverage = count * pi / 4 * diameter * diameter / (extent.x * extent.y);
  if (!(count >= 1)) {
    target.problem("dots_per_32px_window", "gives no dot at all on this target; increase it");
  } else if (count > 4e9) {
    target.problem(
        "dots_per_32px_window",
        fmt::format("gives {:.3g} dots on {:.4g} x {:.4g} mm (4e9 at most; they alone would need {:.3g} GB of memory); "
                    "decrease it, camera.pixels or target.extent_mm",
                    count, extent.x / mm, extent.y / mm, count * 200 / 1e9));
  } else if (setup.target.arrangement == DotArrangement::random && coverage > 0.5) {
    target.problem(
        "dots_per_32px_window",
        fmt::format("dots would cover {:.0f} % of the target (random discs without overlap reach about 50 %); use "
                    "fewer or smaller dots, or arrangement = \"regular\"",
                    100 * coverage));
  }
}

}  // namespace

std::string metres_hint(double length) {
  double const millimetres = length / unit::millimetre;
  if (!(millimetres < 2)) return "";
  return fmt::format(" (lengths are in mm: {0:.6g} mm was given, {0:.6g} m are {1:.6g} mm)", millimetres,
                     1e3 * millimetres);
}

std::vector<std::string> cross_check(Setup const& setup, SetupTable root) {
  std::vector<std::string> warnings = setup.warnings;
  if (!cross_check_lens(setup, root, warnings)) return warnings;  // all other checks require an image
  if (setup.calibration()) {
    cross_check_noise(setup, warnings);
    cross_check_spot(setup, setup.spot_diameter_px(), root.table("lens"), root);
    cross_check_calibration(setup, root, warnings);
    return warnings;
  }
  SetupTable medium = root.table("medium");
  cross_check_geometry(setup, root.table("geometry"));
  cross_check_elements(setup, root);
  cross_check_thickness(setup, warnings);
  cross_check_noise(setup, warnings);
  cross_check_steps(setup, medium);
  cross_check_density(setup, medium, warnings);
  if (setup.medium.second_field) {
    Setup second = setup;
    second.medium = select_second_pulse(setup.medium);
    cross_check_geometry(second, root.table("geometry"));
    cross_check_steps(second, medium, "second_field");
    cross_check_density(second, medium, warnings, "second_field");
  }
  if (setup.piv) {
    cross_check_spot(setup, setup.spot_diameter_px(), root.table("lens"), root);
    cross_check_particles(setup, root, warnings);
    return warnings;
  }
  cross_check_target(setup, root);
  if (setup.target.kind == TargetKind::dots) cross_check_dot_count(setup, root.table("target"));
  return warnings;
}

}  // namespace gladstone
