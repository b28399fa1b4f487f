#include "render/scene/read_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/paraxial.h"
#include "render/scene/best_focus.h"

namespace gladstone::inline scene {

SetupTable camera_table(SetupTable& root) {
  auto cameras = root.tables("camera");
  if (cameras.size() > 1) {
    root.problem("camera",
                 "is an array of several cameras, but this command needs a single one (gladstone render makes a case "
                 "of each); keep one, or use the setup.toml of its case");
    for (std::size_t other = 1; other < cameras.size(); ++other) cameras[other].suppress_unread_keys();
  }
  return cameras.empty() ? root.table("camera") : cameras.front();
}

std::vector<ElementTable> element_tables(SetupTable root) { return element_tables(root, camera_table(root)); }

namespace {

RenderSetup read_render_setup(SetupTable table) {
  RenderSetup setup;
  if (auto const rays = table.number_or_auto("rays_per_dot", Range::at_least(1, 1e7))) {
    if (*rays != std::floor(*rays)) {
      table.problem("rays_per_dot", "is not a whole number; use a whole number or \"auto\"");
    }
    setup.rays_per_dot = static_cast<std::uint64_t>(*rays);
    table.resolve("rays_per_dot", static_cast<long long>(*rays));
  }
  setup.sampling =
      table.choice("sampling", setup.sampling, {{"sobol", PupilSampling::sobol}, {"random", PupilSampling::random}});
  setup.seed = static_cast<std::uint64_t>(
      table.integer("seed", static_cast<long long>(setup.seed), 0, std::numeric_limits<long long>::max()));
  setup.precision = table.choice("precision", setup.precision,
                                 {{"double", Precision::double_precision}, {"single", Precision::single}});
  setup.method = table.choice("method", setup.method,
                              {{"auto", RenderMethod::automatic},
                               {"rays", RenderMethod::rays},
                               {"focused_dots", RenderMethod::focused_dots},
                               {"formula", RenderMethod::formula}});
  return setup;
}

// upper limit of an "auto" half thickness, relative to the distance to dots or lens
constexpr double automatic_reach = 0.99;

/// Sets medium.thickness to the depth of the field's volume, regardless of thickness_mm.
/// @return false if the thickness follows from thickness_mm (slab, extruded plane), or the file cannot be read, which
/// its reader reports
bool take_depth_of_volume(Setup& setup, SetupTable medium) {
  MediumSetup& slab = setup.medium;
  if (!has_own_depth(slab.field) || (slab.second_field && !has_own_depth(*slab.second_field))) return false;
  double depth = 0;
  try {
    Bounds<double> const box = file_bounds(slab);
    depth = box.high.z - box.low.z;
  } catch (DataError const&) {
    return false;
  }
  if (!slab.automatic_thickness && std::abs(slab.thickness - depth) > 1e-6 * depth) {
    setup.warnings.push_back({WarningCode::ignored, "medium.thickness_mm",
                              fmt::format("{:.6g} mm is not used, since a volume has its own depth, {:.6g} mm; leave "
                                          "it out, or give medium.field.spacing_mm",
                                          slab.thickness / unit::millimetre, depth / unit::millimetre)});
  }
  slab.thickness = depth;
  medium.resolve("thickness_mm", depth / unit::millimetre);
  return true;
}

/// Sets the thickness of the medium that all commands use and writes it into the resolved setup: the depth of a volume
/// or, for thickness_mm = "auto", that of the slab, which for a field of finite size ends in front of dots and lens.
void resolve_thickness(Setup& setup, SetupTable medium) {
  MediumSetup& slab = setup.medium;
  if (take_depth_of_volume(setup, medium) || !slab.automatic_thickness) return;
  double thickness_mm = automatic_thickness_mm(slab);
  if (thickness_mm > automatic_thickness_mm(FieldSetup{})) {
    double const way_mm = (setup.z_d == 0 ? setup.z_a : std::min(setup.z_a, setup.z_d)) / unit::millimetre;
    thickness_mm = std::min(thickness_mm, 2 * automatic_reach * way_mm);
  }
  slab.thickness = thickness_mm * unit::millimetre;
  medium.resolve("thickness_mm", thickness_mm);
}

/// Reads table [camera.pose]: position and direction of the camera.
std::optional<Pose<double>> read_pose(SetupTable table) {
  if (!table.present()) return std::nullopt;
  Range const place{-1e9, 1e9};
  if (!table.has("position_mm"))
    table.problem("position_mm", "is missing (position of the camera); add it", ErrorCode::missing_key);
  Pose<double> pose;
  pose.origin = table.quantities("position_mm", {0, 0, 0.75}, unit::millimetre, place);
  if (table.has("rotation_deg")) {
    if (table.has("look_at_mm")) {
      table.problem("rotation_deg", "conflicts with look_at_mm (both set the direction of view); remove one");
    }
    pose = pose.turned(table.quantities("rotation_deg", Vec3d{}, unit::degree, {-360, 360}));
  } else {
    Vec3d const towards = pose.origin - table.quantities("look_at_mm", Vec3d{}, unit::millimetre, place);
    Vec3d const right = cross(Vec3d{0, 1, 0}, towards);
    if (!(length(right) > 1e-9 * length(towards)) || towards == Vec3d{}) {
      table.problem("look_at_mm",
                    "is directly above, below or at the camera, so that the upright direction of the image is "
                    "undefined; use rotation_deg");
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
                  "degrees of the normal, from the side of positive Z); change the direction of view");
    return std::nullopt;
  }
  return pose;
}

/// Reads the camera's position: z_a_mm, z_front_mm, z_sensor_mm or a pose.
void read_place(Setup& setup, SetupTable camera, SetupTable geometry) {
  SetupTable pose = camera.table("pose");
  setup.pose = read_pose(pose);
  for (char const* key : {"z_a_mm", "z_front_mm", "z_sensor_mm"}) {
    if (pose.present()) geometry.refuse(key, "conflicts with camera.pose (which positions the camera); remove one");
  }
  if (pose.present()) {
    if (setup.pose) setup.z_a = setup.pose->origin.z / setup.pose->z.z;
    return;
  }
  bool const thin = setup.lens.file.empty();
  if (geometry.has("z_sensor_mm")) {  // the lens is positioned after it is read
    for (char const* key : {"z_a_mm", "z_front_mm"}) {
      geometry.refuse(key, "conflicts with z_sensor_mm (both position the lens); remove one");
    }
    setup.z_sensor = geometry.number("z_sensor_mm", 900.0, Range::positive(1e9)) * unit::millimetre;
    return;
  }
  if (thin) geometry.refuse("z_front_mm", "is for prescriptions only (a thin lens has no first vertex); use z_a_mm");
  if (thin || !geometry.has("z_front_mm")) {
    setup.z_a = geometry.quantity("z_a_mm", setup.z_a, unit::millimetre, Range::positive(1e9));
    return;
  }
  geometry.refuse("z_a_mm", "conflicts with z_front_mm (both position the lens); remove one");
  setup.z_a = geometry.number("z_front_mm", 700.0, Range::positive(1e9)) * unit::millimetre;
}

/// Looks up the glasses of optical elements. Problems are recorded at the keys `glass`.
void find_element_glasses(Setup& setup, std::vector<ElementTable> tables, GlassCatalogue const& glasses,
                          Warnings& warnings) {
  double const wavelength = setup.medium.wavelength;
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    std::string const* const name = setup.elements[i].glass();
    if (!name) continue;
    std::string const where = tables[i].table.where("glass");
    try {
      GlassMatch const found = glasses.match(*name, wavelength, where);
      warnings.insert(warnings.end(), found.notes.begin(), found.notes.end());
      Glass const& glass = *found.glass;
      bool const absorbs = setup.lens.transmittance == Transmittance::glass;
      setup.elements[i].set_glass(glass.index(wavelength), absorbs ? glass.absorption(wavelength) : 0);
    } catch (DataError const& error) {
      tables[i].table.problem("glass", error.message(), error.code());
    }
  }
}

/// Prepares lens and other optical elements for the setup's wavelength, and determines the principal plane of a lens
/// that is positioned by its first vertex.
void build_optics(Setup& setup, SetupTable root, std::vector<ElementTable> const& elements, Warnings& warnings) {
  SetupTable lens = root.table("lens"), geometry = root.table("geometry");
  GlassCatalogue const glasses = read_glasses(setup.lens, lens);
  warnings.insert(warnings.end(), glasses.warnings().begin(), glasses.warnings().end());
  if (!setup.lens.file.empty()) {
    std::optional<double> object_distance;
    // z_a is not yet converted: it is measured from the first vertex
    if (geometry.has("z_front_mm")) object_distance = setup.focus_distance();
    build_prescription(setup.lens, lens, glasses, setup.medium.wavelength, object_distance, warnings);
  }
  if (setup.lens.prescription) {
    ParaxialLens const paraxial = paraxial_lens(*setup.lens.prescription);
    double const principal = paraxial.front_principal_plane;
    bool const afocal = !std::isfinite(principal), telecentric = paraxial.telecentric;
    if (geometry.has("z_front_mm")) {
      if (!afocal) setup.z_a += principal;
    } else if (!setup.z_sensor && (afocal || telecentric) && !setup.pose) {
      geometry.problem(
          "z_a_mm",
          fmt::format("cannot position {} lens (it has no {}); give z_front_mm, the position of its first vertex",
                      afocal ? "an afocal" : "a telecentric",
                      afocal ? "principal planes" : "entrance pupil at a finite distance"));
    }
  }
  find_element_glasses(setup, elements, glasses, warnings);
}

/// Positions the lens such that it is focused on a sensor at a given position.
void focus_on_sensor(Setup& setup, SetupTable geometry) {
  if (!setup.z_sensor) return;
  bool const known = setup.lens.file.empty() || setup.lens.prescription;
  if (known && !std::isfinite(setup.lens.focal_length)) {
    geometry.problem("z_sensor_mm", "cannot position an afocal lens (it has no focus); give z_front_mm");
  } else if (known) {
    try {
      position_lens_from_sensor(setup);
    } catch (DataError const& error) {
      geometry.problem("z_sensor_mm", error.what(), error.code());
    }
  }
}

}  // namespace

void refuse_piv_tables(Setup const& setup, SetupTable root) {
  if (setup.medium.second_field) {
    root.table("medium").problem("second_field",
                                 "applies to PIV only (field at the second pulse); remove it, or change experiment");
  }
  for (char const* other : {"particles", "laser", "flow"}) {
    root.refuse(other, "requires experiment = \"piv\"; remove it, or change experiment");
  }
}

Setup read_setup(SetupTable root) {
  if (root.integer("schema", 1, 0, 1000000) != 1) {
    root.problem("schema", "is not 1 (this version reads schema 1 only); use a matching version of gladstone");
  }
  std::vector<std::string> names;
  for (Experiment const* one : all_experiments) names.emplace_back(one->name);
  Experiment const& experiment = find_experiment(root.word("experiment", names.front(), names));
  Setup setup;
  SetupTable camera = camera_table(root);
  setup.camera = read_camera_setup(camera);
  setup.lens = read_lens_setup(root.table("lens"), experiment.focus_word);
  std::vector<ElementTable> const elements = element_tables(root, camera);
  setup.elements = read_elements(elements);
  if (!setup.lens.file.empty() && setup.camera.distorted()) {
    camera.table("sensor").problem("distortion",
                                   "applies to thin lenses only (a prescription has its own distortion); remove it");
  }
  SetupTable geometry = root.table("geometry");
  read_place(setup, camera, geometry);
  experiment.read_z_d(setup, geometry);
  setup.medium = read_medium_setup(root.table("medium"));
  build_optics(setup, root, elements, setup.warnings);
  focus_on_sensor(setup, geometry);
  resolve_thickness(setup, root.table("medium"));
  if (setup.camera.absolute_exposure && !experiment.sources.in_photons) {
    camera.problem("exposure",
                   "\"absolute\" applies to PIV only (where [laser] determines the amount of light); use \"auto\" or a "
                   "number of electrons");
  }
  experiment.read(setup, root);
  if (setup.sequence) setup.camera.noise.frames = setup.sequence->frames_of(setup.sequence->pair);
  setup.render = read_render_setup(root.table("render"));
  return setup;
}
}  // namespace gladstone::inline scene
