#include "render/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/files/fields/field_file.h"
#include "render/light/calibration_target.h"
#include "render/scene/build_camera.h"

namespace gladstone::inline scene {
namespace {

double gigabytes(double bytes) { return bytes / 1e9; }

/// Returns the lowest density of a field file [kg/m^3].
/// @pre its quantity is density
double lowest_density(MediumSetup const& setup, BuiltMedium const& medium) {
  auto const lowest = [&]<class Stored>(Stored) {
    return std::static_pointer_cast<RefractiveIndexVolume<Stored> const>(medium.owner)->lowest();
  };
  return (setup.field.extrude ? lowest(double{}) : lowest(float{})) /
         setup.gladstone_dale;  // type in which build_medium() stores the values
}

/// Reports negative densities in a field file, with their number and the first position.
void refuse_negative_density(MediumSetup const& setup, BuiltMedium const& medium) {
  FieldSetup const& field = setup.field;
  if (field.kind != FieldKind::file || field.quantity != FieldQuantity::density) return;
  double const lowest = lowest_density(setup, medium);
  if (lowest >= 0) return;
  auto const source = open_field(field.file, field.dataset, 1, field.axes);
  RegularGrid const& grid = source->grid();
  auto const width = static_cast<std::size_t>(grid.nodes[0]);
  std::vector<double> plane(width * static_cast<std::size_t>(grid.nodes[1]));
  std::size_t count = 0;
  std::string first;
  for (int k = 0; k < grid.nodes[2]; ++k) {
    throw_if_interrupted();
    source->read_planes(k, 1, plane);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (field.scale.value_or(1) * plane[i] >= 0) continue;
      if (count++ == 0) first = fmt::format("{}, {}, {}", i % width, i / width, k);
    }
  }
  throw DataError(
      ErrorCode::out_of_range, field.file,
      fmt::format("dataset \"{}\": {} of {} points are negative densities (the first at node x, y, z = {}; the lowest "
                  "is {:.6g} kg/m^3); correct the field, or check medium.field.quantity and scale",
                  source->name(), count, grid.size(), first, lowest));
}

}  // namespace

double Scene::steps_across(double step) const {
  Bounds<double> const box = std::visit([](auto const& seen) { return seen.bounds(); }, medium.view);
  return step > 0 ? (box.high.z - box.low.z) / step : 0;
}

double Scene::stop_edge(double rays) { return 1.2 / std::pow(rays, 0.25); }

void check_deflection_limit(double shift, double z_b) {
  if (shift <= z_b) return;
  throw DataError(ErrorCode::out_of_range, KeyPath{"medium.field"},
                  fmt::format("deflects rays by more than {:.3g} mm before they reach the lens, {:.6g} mm away, which "
                              "no real set-up does; reduce its gradients, or check their unit",
                              shift / unit::millimetre, z_b / unit::millimetre));
}

double Scene::spot_scale_px() const { return setup.spot_scale_px(); }

double Scene::spot_sigma_px() const { return setup.lens.spot == SpotModel::airy ? 0 : setup.spot_e2_diameter_px() / 4; }

bool Scene::in_view(Vec2d on_target) const { return camera.sensor.covers(to_pixel(on_target)); }

Pose<double> Scene::sheet_plane() const {
  LaserSheet<double> const sheet = laser_sheet(setup.piv->laser);
  Pose<double> plane = sheet.pose[0];
  plane.origin = 0.5 * (sheet.pose[0].origin + sheet.pose[1].origin);
  plane.z = normalized(sheet.pose[0].z + sheet.pose[1].z);
  plane.y = cross(plane.z, plane.x);
  return plane;
}

Vec2d Scene::to_pixel(Vec2d on_target) const {
  return camera.project({on_target.x, on_target.y, -setup.z_d}).value_or(Vec2d{not_a_number, not_a_number});
}

Vec2d Scene::to_target(Vec2d pixel) const {
  auto const seen = camera.unproject(pixel, target_plane());
  return seen ? seen->place : Vec2d{not_a_number, not_a_number};
}

DotPattern build_target(Setup const& setup) {
  DotPattern dots;
  double const diameter = setup.target.kind == TargetKind::image ? 0.0 : setup.dot_diameter();
  switch (setup.target.kind) {
    case TargetKind::dots:
      if (setup.target.arrangement == DotArrangement::random) {
        dots.centre = random_dots(setup.target_extent(), static_cast<std::size_t>(setup.dot_count()), diameter,
                                  setup.target.seed);
      } else {
        Vec2d const extent = setup.target_extent();
        dots.centre = regular_dots(extent, setup.dot_count() / (extent.x * extent.y), diameter);
      }
      break;
    case TargetKind::lattice:
      dots.centre = Lattice(setup.target).dots();
      break;
    case TargetKind::points:
      dots.centre = dots_from_csv(setup.target.file, setup.max_off_axis_distance());
      break;
    case TargetKind::image:
      dots = image_target(setup.target.file, setup.target_extent());
      break;
  }
  if (setup.target.kind != TargetKind::image) dots.half_size = diameter / 2;
  if (Vec2d const middle = setup.target_centre(); setup.target.kind != TargetKind::points && !(middle == Vec2d{})) {
    for (Vec2d& centre : dots.centre) centre = centre + middle;
  }
  return dots;
}

std::vector<MemoryRequirement> memory_requirements(Setup const& setup, FieldMemory field_memory) {
  double const pixels = static_cast<double>(setup.camera.columns) * setup.camera.rows;
  std::vector<MemoryRequirement> needs{
      {"camera.pixels", "images", pixels * 2 * (sizeof(std::int64_t) + sizeof(double) + sizeof(std::uint16_t))},
      {"medium.field.file", "field",
       field_memory == FieldMemory::needed ? static_cast<double>(medium_bytes_needed(setup.medium)) : 0}};
  std::vector<MemoryRequirement> const of_sources = setup.experiment().sources.memory(setup);
  needs.insert(needs.end(), of_sources.begin(), of_sources.end());
  return needs;
}

void check_memory(Setup const& setup, FieldMemory field_memory, std::vector<MemoryRequirement> const& more) {
  std::vector<MemoryRequirement> needs = memory_requirements(setup, field_memory);
  needs.insert(needs.end(), more.begin(), more.end());
  double needed = 0;
  std::string sizes;
  for (MemoryRequirement const& need : needs) {
    needed += need.bytes;
    sizes += fmt::format("{}{} {:.3g}", sizes.empty() ? "" : ", ", need.what, gigabytes(need.bytes));
  }
  double const available = available_memory();
  if (needed <= available) return;
  auto const most =
      std::max_element(needs.begin(), needs.end(),
                       [](MemoryRequirement const& a, MemoryRequirement const& b) { return a.bytes < b.bytes; });
  throw DataError(ErrorCode::memory, KeyPath{most->key},
                  fmt::format("needs {:.3g} GB of memory ({}), but {:.3g} GB are available; reduce {}",
                              gigabytes(needed), sizes, gigabytes(available), most->key));
}

BuiltMedium build_checked_medium(MediumSetup const& setup) {
  BuiltMedium medium = build_medium(setup);
  refuse_negative_density(setup, medium);
  return medium;
}

Scene build_scene(Setup const& setup, BuiltMedium const* medium) {
  check_memory(setup, medium ? FieldMemory::taken : FieldMemory::needed);
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  if (!setup.has_closed_form_layout()) {  // use the actual sensor position
    if (auto const axis = scene.camera.unproject(scene.camera.sensor.axis_pixel(), scene.target_plane())) {
      double const area = std::abs(axis->by_x.x * axis->by_y.y - axis->by_x.y * axis->by_y.x);  // [px^2/m^2]
      scene.imaging.magnification = setup.camera.pixel_pitch * std::sqrt(area);
    }
  }
  setup.experiment().sources.add(scene);
  scene.medium = medium ? *medium : build_checked_medium(setup.medium);
  if (setup.medium.second_field) scene.second_medium = build_checked_medium(select_second_pulse(setup.medium));
  if (setup.medium.field.kind == FieldKind::file && !setup.medium.field.extrude) {
    Bounds<double> const box = std::visit([](auto const& view) { return view.bounds(); }, scene.medium.view);
    bool const dots_inside = setup.experiment().sources.on_target && -setup.z_d > box.low.z;
    if (dots_inside || setup.camera_pose().origin.z < box.high.z) {
      throw DataError(
          ErrorCode::invalid_value, setup.medium.field.where,
          fmt::format("medium.field.file: the dots or the lens lie inside the volume, which reaches from z = {:.6g} to "
                      "{:.6g} mm about the mid-plane; change geometry.z_a_mm, z_d_mm or medium.field.center_mm",
                      box.low.z / unit::millimetre, box.high.z / unit::millimetre));
    }
  }
  return scene;
}

}  // namespace gladstone::inline scene
