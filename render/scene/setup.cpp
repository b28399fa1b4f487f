#include "render/scene/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "render/medium/analytic_fields.h"
#include "render/medium/field_volume.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/paraxial.h"
#include "render/scene/build_camera.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone {
namespace {

constexpr double widest_spot_px = 200;   // between first zeros; f/64 gives about 10 px
constexpr double widest_airy_px = 60;    // its table takes 0.2 GB then
constexpr double finest_pitch = 0.5e-6;  // [m] no camera's pixels are finer
constexpr double fastest_lens = 0.5;     // f-number at which an aplanatic lens in air takes a half space

RenderSetup read_render_setup(SetupTable table) {
  RenderSetup setup;
  if (auto const rays = table.number_or_auto("rays_per_dot", Range::at_least(1, 1e7))) {
    if (*rays != std::floor(*rays)) {
      table.problem("rays_per_dot", "is not a whole number (rays are counted); use a whole number or \"auto\"");
    }
    setup.rays_per_dot = static_cast<std::uint64_t>(*rays);
    table.resolve("rays_per_dot", static_cast<long long>(*rays));
  }
  if (table.word("sampling", "sobol", {"sobol", "random"}) == "random") setup.sampling = PupilSampling::random;
  setup.seed = static_cast<std::uint64_t>(table.integer("seed", 1, 0, std::numeric_limits<long long>::max()));
  if (table.word("precision", "double", {"double", "single"}) == "single") setup.precision = Precision::single;
  std::string const method = table.word("method", "auto", {"auto", "rays", "focused_dots"});
  if (method == "rays") setup.method = RenderMethod::rays;
  if (method == "focused_dots") setup.method = RenderMethod::focused_dots;
  return setup;
}

SetupTable camera_table(SetupTable& root) {
  auto cameras = root.tables("camera");
  if (cameras.size() > 1) {
    root.problem("camera", "is an array of several cameras, which is not available yet (one camera a setup); keep one");
    for (std::size_t other = 1; other < cameras.size(); ++other) cameras[other].excuse();
  }
  return cameras.empty() ? root.table("camera") : cameras.front();
}

/// A hint where a length in mm looks like one in metres; empty where it does not.
std::string metres_hint(double length) {
  double const millimetres = length / unit::millimetre;
  if (!(millimetres < 2)) return "";
  return fmt::format(" (lengths are in mm: {0:.6g} mm was given, {0:.6g} m are {1:.6g} mm)", millimetres,
                     1e3 * millimetres);
}

constexpr double automatic_reach = 0.99;  // of the way to dots and lens, that a thickness of "auto" may take
constexpr double negligible_loss = 0.01;  // of a field's displacement, cut off by a thickness that the user chose
constexpr double noticeable_loss = 1e-4;  // cut off where the user chose none: 1e-4 px in a pixel, as truth is good to

/// Writes down what thickness_mm = "auto" came to; a field with a size ends short of the dots and the lens.
void resolve_thickness(Setup& setup, SetupTable medium) {
  MediumSetup& slab = setup.medium;
  if (!slab.automatic_thickness) return;
  double thickness_mm = automatic_thickness_mm(slab.field);
  if (has_size_along_z(slab.field.kind)) {
    double const way_mm = std::min(setup.z_a, setup.z_d) / unit::millimetre;
    thickness_mm = std::min(thickness_mm, 2 * automatic_reach * way_mm);
  }
  slab.thickness = thickness_mm * unit::millimetre;
  medium.resolve("thickness_mm", thickness_mm);
}

/// Fields whose slab ends where they are still large, and volumes whose thickness was given in vain.
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

/// Refuses closed forms that make no medium of which a file would be accepted, and densities below zero, which no gas
/// has. A uniform gradient has those somewhere whatever it is: there they are a warning, and optically linear beyond.
void cross_check_density(Setup const& setup, SetupTable medium, std::vector<std::string>& warnings) {
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
    medium.tables("field").front().problem(
        key, fmt::format("gives refractive indices from {:.6g} to {:.6g} where rays cross the field (no such medium); "
                         "check it and medium.gladstone_dale",
                         1 + K * lowest, 1 + K * highest));
  } else if (lowest >= 0) {
    return;
  } else if (field.kind == FieldKind::uniform_gradient) {
    Vec2d const half = half_extent_at_medium(setup);
    warnings.push_back(
        fmt::format("medium.field.gradient_kg_m4: the density is negative, {:.4g} kg/m^3 at the lowest, over a part of "
                    "the {:.4g} x {:.4g} mm that rays cross (no gas has that); reduce the gradient or increase "
                    "medium.ambient_density_kg_m3",
                    lowest, 2 * half.x / unit::millimetre, 2 * half.y / unit::millimetre));
  } else {
    medium.tables("field").front().problem(
        key,
        fmt::format("makes the density negative, {:.6g} kg/m^3 at the lowest (about medium.ambient_density_kg_m3 = "
                    "{:.6g}); reduce the amplitude or increase the ambient density",
                    lowest, ambient));
  }
}

/// Spots whose diameter is told as four standard deviations, see Setup::spot_diameter_px.
bool four_sigma(SpotModel spot) { return spot == SpotModel::gaussian_first_zero || spot == SpotModel::seed_eq8; }

/// Builds a camera that no closed form describes, to see whether it makes a picture of the dots.
bool cross_check_camera(Setup const& setup, SetupTable root) {
  std::string const lens = "lens: ";
  try {
    build_camera(setup);
    setup.target_extent();
    return true;
  } catch (DataError const& error) {
    std::string const text = error.what();
    if (text.starts_with(lens)) {
      root.table("lens").problem(setup.lens.prescription ? "file" : "focus", text.substr(lens.size()));
    } else {
      camera_table(root).problem("pose", text.substr(text.find(' ') + 1));
    }
  }
  return false;
}

/// Refuses views and targets that reach further off the axis than a lens sees: chief rays from there never end.
void cross_check_extents(Setup const& setup, Vec2d view, SetupTable target, SetupTable root) {
  double const widest = 2 * setup.farthest_off_axis(), mm = unit::millimetre;
  if (std::max(view.x, view.y) > widest) {
    camera_table(root).problem(
        "pixel_pitch_um",
        fmt::format("makes a field of view of {:.4g} x {:.4g} mm ({:.4g} mm at most, 168 degrees: no lens sees more); "
                    "pitches are in um; use a longer lens or fewer or smaller pixels",
                    view.x / mm, view.y / mm, widest / mm));
  } else if (setup.target.extent_m && std::max(setup.target.extent_m->x, setup.target.extent_m->y) > widest) {
    target.problem("extent_mm",
                   fmt::format("reaches beyond what any lens sees, 168 degrees ({:.4g} mm at most, ten times "
                               "the way to the lens to each side); use the view or a little more",
                               widest / mm));
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

/// Refuses what no ray would ever come to the end of: a step, or a length of the field, that is tiny beside the medium.
/// A file that cannot be read is left to those who read it.
void cross_check_steps(Setup const& setup, SetupTable medium) {
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
  medium.tables("field").front().problem(
      key, fmt::format("makes the field so fine that a ray would need {:.3g} steps across the medium ({:.0g} at most); "
                       "{}lengths are in mm",
                       steps, most_steps, key == "file" ? "give medium.field.spacing_mm; " : "use a longer one; "));
}

/// Table [camera.pose]: where the camera stands and looks.
std::optional<Pose<double>> read_pose(SetupTable table) {
  if (!table.present()) return std::nullopt;
  auto const vector = [&table](char const* key, std::vector<double> const& fallback, Range range) {
    auto const v = table.numbers(key, fallback, 3, range);
    return v.size() == 3 ? Vec3d{v[0], v[1], v[2]} : Vec3d{};
  };
  Range const place{-1e9, 1e9};
  if (!table.has("position_mm")) table.problem("position_mm", "is missing (where the camera stands); add it");
  Pose<double> pose;
  pose.origin = vector("position_mm", {0, 0, 750}, place) * unit::millimetre;
  if (table.has("rotation_deg")) {
    if (table.has("look_at_mm")) {
      table.problem("rotation_deg", "stands beside look_at_mm (one of them says where the camera looks); remove one");
    }
    pose = pose.turned(vector("rotation_deg", {0, 0, 0}, {-360, 360}) * unit::degree);
  } else {
    Vec3d const towards = pose.origin - vector("look_at_mm", {0, 0, 0}, place) * unit::millimetre;
    Vec3d const right = cross(Vec3d{0, 1, 0}, towards);
    if (!(length(right) > 1e-9 * length(towards)) || towards == Vec3d{}) {
      table.problem("look_at_mm",
                    "is straight above, below or where the camera stands (its picture has no upright then); use "
                    "rotation_deg");
      return std::nullopt;
    }
    pose.z = normalized(towards);
    pose.x = normalized(right);
    pose.y = cross(pose.z, pose.x);
  }
  double const roll = table.number("roll_deg", 0, {-360, 360}) * unit::degree;
  pose = pose.turned({0, 0, roll});
  constexpr double least_cosine = 0.05;
  if (!(pose.z.z > least_cosine)) {
    table.problem(table.has("rotation_deg") ? "rotation_deg" : "look_at_mm",
                  "turns the camera away from the dots, or along their plane (its axis must meet Z = 0 within 87 "
                  "degrees of the normal, from the side of positive Z); look another way");
    return std::nullopt;
  }
  return pose;
}

/// The camera's place: z_a_mm, z_front_mm or a pose.
void read_place(Setup& setup, SetupTable camera, SetupTable geometry) {
  SetupTable pose = camera.table("pose");
  setup.pose = read_pose(pose);
  for (char const* key : {"z_a_mm", "z_front_mm"}) {
    if (pose.present()) geometry.refuse(key, "stands beside camera.pose (which places the camera); remove one");
  }
  if (pose.present()) {
    if (setup.pose) setup.z_a = setup.pose->origin.z / setup.pose->z.z;
    return;
  }
  bool const thin = setup.lens.file.empty();
  if (thin) geometry.refuse("z_front_mm", "is of prescriptions (a thin lens has no first vertex); use z_a_mm");
  if (thin || !geometry.has("z_front_mm")) {
    setup.z_a = geometry.number("z_a_mm", 750.0, Range::positive(1e9)) * unit::millimetre;
    return;
  }
  geometry.refuse("z_a_mm", "stands beside z_front_mm (one of them places the lens); remove one");
  setup.z_a = geometry.number("z_front_mm", 700.0, Range::positive(1e9)) * unit::millimetre;
}

/// Makes lens and windows ready at the setup's wavelength, and finds the principal plane of a lens that is placed by
/// its first vertex.
void build_optics(Setup& setup, SetupTable root, std::vector<std::string>& warnings) {
  SetupTable lens = root.table("lens"), geometry = root.table("geometry");
  if (!setup.lens.file.empty()) build_prescription(setup.lens, lens, setup.medium.wavelength, warnings);
  if (setup.lens.prescription) {
    ParaxialLens const paraxial = paraxial_lens(*setup.lens.prescription);
    double const principal = paraxial.front_principal_plane;
    bool const afocal = !std::isfinite(principal), telecentric = !std::isfinite(paraxial.entrance.position);
    if (geometry.has("z_front_mm")) {
      if (!afocal) setup.z_a += principal;
    } else if ((afocal || telecentric) && !setup.pose) {
      geometry.problem("z_a_mm",
                       fmt::format("cannot place {} lens (it is no distance of its {}); give z_front_mm, of "
                                   "its first vertex",
                                   afocal ? "an afocal" : "a telecentric", afocal ? "principal plane" : "perspective"));
    }
  }
  for (WindowSetup& window : setup.windows) {
    try {
      window.index = GlassCatalogue::shipped()
                         .find(window.glass, setup.medium.wavelength, window.where)
                         .index(setup.medium.wavelength);
    } catch (DataError const& error) {
      root.problem("window", error.what());
    }
  }
}

}  // namespace

double Setup::focus_distance() const {
  switch (lens.focus) {
    case Focus::target:
      return z_b();
    case Focus::medium:
      return z_a;
    case Focus::distance:
      break;
  }
  return lens.focus_distance;
}

ImagingGeometry Setup::imaging() const {
  if (!lens.prescription && windows.empty()) {
    return thin_lens_imaging(lens.focal_length, lens.f_number, focus_distance(), z_b());
  }
  return paraxial_imaging(*this, paraxial_camera(*this));
}

Vec2d Setup::target_centre() const {
  if (!pose) return {};
  Vec3d const there = pose->origin - z_b() * pose->z;
  return {there.x, there.y};
}

Vec2d Setup::target_extent() const {
  if (target.extent_m) return *target.extent_m;
  if (pose || camera.tilted()) return posed_extent(*this);
  // through mm, so that the resolved setup, which holds mm, gives the same dots to the last bit
  double const px_mm = camera.pixel_pitch / imaging().magnification / unit::millimetre;
  return Vec2d{(camera.columns + 2.0 * view_margin_px) * px_mm, (camera.rows + 2.0 * view_margin_px) * px_mm} *
         unit::millimetre;
}

double Setup::dot_diameter() const {
  if (target.dot_diameter_m) return *target.dot_diameter_m;
  return target.dot_diameter_px.value_or(0.0) * camera.pixel_pitch / imaging().magnification;
}

double Setup::spot_scale_px() const {
  ImagingGeometry const geometry = imaging();
  if (geometry.entrance_pupil == 0) return 0;
  return geometry.image_distance / geometry.entrance_pupil * medium.wavelength / camera.pixel_pitch;
}

double Setup::spot_diameter_px() const {
  if (lens.spot == SpotModel::none) return 0;
  return SpotSize{spot_scale_px()}.first_zero_diameter() * (lens.spot == SpotModel::seed_eq8 ? pi : 1.0);
}

double Setup::dot_count() const {
  Vec2d const extent = target_extent();
  double const px = camera.pixel_pitch / imaging().magnification;
  return std::round(target.dots_per_32px_window / 1024.0 * extent.x * extent.y / (px * px));
}

Setup read_setup(SetupTable root) {
  if (root.integer("schema", 1, 0, 1000000) != 1) {
    root.problem("schema", "is not 1 (this version reads schema 1 only); use a matching version of gladstone");
  }
  std::string const experiment = root.word("experiment", "bos", {"bos", "piv", "calibration"});
  if (experiment != "bos") {
    root.problem("experiment", "\"" + experiment + "\" is not available yet (this version simulates BOS); use \"bos\"");
  }
  Setup setup;
  SetupTable camera = camera_table(root);
  setup.camera = read_camera_setup(camera);
  setup.lens = read_lens_setup(root.table("lens"));
  setup.windows = read_windows(root);
  if (!setup.lens.file.empty() && setup.camera.distorted()) {
    camera.table("sensor").problem("distortion", "is of thin lenses (a prescription has its own); remove it");
  }
  SetupTable geometry = root.table("geometry");
  read_place(setup, camera, geometry);
  setup.z_d = geometry.number("z_d_mm", 250.0, Range::positive(1e9)) * unit::millimetre;
  setup.medium = read_medium_setup(root.table("medium"));
  build_optics(setup, root, setup.warnings);
  resolve_thickness(setup, root.table("medium"));
  setup.target = read_target_setup(root.table("target"));
  setup.render = read_render_setup(root.table("render"));
  for (char const* later : {"particles", "laser_sheet", "velocity", "calibration", "requirements"}) {
    root.refuse(later, "is not available yet (this version simulates BOS); remove it");
  }
  return setup;
}

std::vector<std::string> cross_check(Setup const& setup, SetupTable root) {
  std::vector<std::string> warnings = setup.warnings;
  double const mm = unit::millimetre;
  SetupTable lens = root.table("lens"), geometry = root.table("geometry"), target = root.table("target");
  if (setup.lens.f_number < fastest_lens) {
    lens.problem("f_number", fmt::format("is below {} (no lens in air opens wider than twice its focal length); stop "
                                         "it down",
                                         fastest_lens));
    return warnings;  // everything else needs an aperture
  }
  if (!setup.lens.prescription && setup.focus_distance() <= setup.lens.focal_length) {
    bool const by_distance = setup.lens.focus == Focus::distance;
    (by_distance ? lens : geometry)
        .problem(by_distance ? "focus_distance_mm" : "z_a_mm",
                 fmt::format(
                     "focus is impossible: the plane in focus lies {:.6g} mm from a lens of {:.6g} mm focal length (an "
                     "image needs more than the focal length); move the lens away or take a shorter one{}",
                     setup.focus_distance() / mm, setup.lens.focal_length / mm, metres_hint(setup.focus_distance())));
    return warnings;  // everything else needs an image
  }
  if (!setup.lens.prescription && setup.z_b() <= setup.lens.focal_length) {
    geometry.problem("z_a_mm", "the dots lie within the focal length (no image of them exists); move the lens away");
    return warnings;
  }
  if (!setup.on_bench() && !cross_check_camera(setup, root)) return warnings;  // everything else needs a picture
  if (std::string const hint = metres_hint(setup.lens.focal_length); !hint.empty() && !setup.lens.prescription) {
    warnings.push_back("lens.focal_length_mm: so short a lens makes a tiny picture of a wide field" + hint);
  }
  FieldKind const kind = setup.medium.field.kind;
  if (kind != FieldKind::none && (kind != FieldKind::file || setup.medium.field.extrude)) {
    double const half = setup.medium.thickness / 2, centre = setup.medium.field.center.z;
    if (-setup.z_d > centre - half) {
      geometry.problem(
          "z_d_mm", fmt::format("the dots lie {} the medium, which begins {:.6g} mm from its mid-plane; increase "
                                "z_d_mm beyond {:.6g} or make the medium thinner{}",
                                -setup.z_d < centre + half ? "inside" : "in front of", half / mm, (half - centre) / mm,
                                metres_hint(setup.z_d)));
    }
    if (setup.camera_pose().origin.z < centre + half) {
      geometry.problem("z_a_mm",
                       fmt::format("the lens lies inside the medium, which ends {:.6g} mm from its mid-plane; increase "
                                   "z_a_mm or make the medium thinner{}",
                                   half / mm, metres_hint(setup.z_a)));
    }
  }
  cross_check_thickness(setup, root.table("medium"), warnings);
  if (double const clipped = clipped_at_black(setup.camera); clipped > 0.05) {
    NoiseSetup const& noise = setup.camera.noise;
    double const levels = noise.read_noise_e * (std::pow(2.0, setup.camera.bit_depth) - 1) / noise.full_well_e;
    warnings.push_back(fmt::format(
        "camera.offset_dn: the read noise of {:.3g} grey levels is cut off at black, which makes dark pixels "
        "{:.3g} levels too bright on average and dim ones less (levels are never below 0); set "
        "camera.offset_dn = {:.0f} or more, as cameras do",
        levels, clipped, std::ceil(4 * levels)));
  }
  cross_check_steps(setup, root.table("medium"));
  cross_check_density(setup, root.table("medium"), warnings);
  double const magnification = setup.imaging().magnification;
  double const px = setup.camera.pixel_pitch / magnification;
  Vec2d const view{setup.camera.columns * px, setup.camera.rows * px};
  if (setup.target.extent_m && (setup.target.extent_m->x < view.x || setup.target.extent_m->y < view.y)) {
    target.problem("extent_mm",
                   fmt::format("the field of view, {:.4g} x {:.4g} mm at the dots, is larger than the target; "
                               "enlarge the target or leave extent_mm out",
                               view.x / mm, view.y / mm));
  }
  cross_check_extents(setup, view, target, root);
  if (setup.target.kind != TargetKind::image) {
    double const diameter_px = setup.dot_diameter() / px;
    double const diffraction_px = setup.spot_diameter_px();
    double const widest_px = setup.lens.spot == SpotModel::airy ? widest_airy_px : widest_spot_px;
    if (diffraction_px > widest_px && setup.camera.pixel_pitch < finest_pitch) {
      camera_table(root).problem("pixel_pitch_um",
                                 fmt::format("makes the diffraction spot {:.4g} px wide ({} at most: nothing could be "
                                             "seen); pitches are in um, and pixels of cameras are 1 to 20 of them wide",
                                             diffraction_px, widest_px));
    } else if (diffraction_px > widest_px) {
      lens.problem("f_number",
                   fmt::format("the diffraction spot would be {:.4g} px wide ({} at most: nothing could be seen); open "
                               "the lens or focus farther away",
                               diffraction_px, widest_px));
    }
    double const image_px = std::hypot(diameter_px, diffraction_px);
    if (image_px < 2) {
      warnings.push_back(fmt::format(
          "dot images are {:.2f} px wide (geometric image {:.2f} px, diffraction spot {:.2f} px {}): below 2 "
          "px correlation locks to whole pixels; enlarge target.dot_diameter_px",
          image_px, diameter_px, diffraction_px,
          four_sigma(setup.lens.spot) ? "over four standard deviations" : "between its first zeros"));
    }
    if (setup.target.polarity == Polarity::dark && diameter_px == 0) {
      target.problem("polarity", "dark dots of no size cannot be seen; give dot_diameter_px");
    }
  }
  if (setup.target.kind == TargetKind::dots) {
    double const count = setup.dot_count();
    double const diameter = setup.dot_diameter();
    Vec2d const extent = setup.target_extent();
    double const coverage = count * pi / 4 * diameter * diameter / (extent.x * extent.y);
    if (!(count >= 1)) {
      target.problem("dots_per_32px_window", "gives no dot at all on this target; increase it");
    } else if (count > 4e9) {
      target.problem(
          "dots_per_32px_window",
          fmt::format(
              "gives {:.3g} dots on {:.4g} x {:.4g} mm (4e9 at most; they alone would need {:.3g} GB of memory); "
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
  return warnings;
}

}  // namespace gladstone
