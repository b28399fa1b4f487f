#include "render/scene/cross_check_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/cross_check.h"
#include "render/scene/read_setup.h"

/// Checks that no objects between the dots and the lens overlap.
namespace gladstone::inline scene {
namespace {

constexpr double touching = 1e-9;  // tolerance for faces in contact [m]

/// Ends of the medium along Z, if the setup determines them (those of a volume are stored in its file).
struct MediumEnds {
  double first, last;  ///< Z of the two ends [m]
};
std::optional<MediumEnds> medium_ends(Setup const& setup) {
  FieldKind const kind = setup.medium.field.kind;
  if (kind == FieldKind::none || (kind == FieldKind::file && !setup.medium.field.extrude)) return std::nullopt;
  double const half = setup.medium.thickness / 2, centre = setup.medium.field.center.z;
  return MediumEnds{centre - half, centre + half};
}

/// Returns the point where the camera's axis enters the camera: the first vertex of its lens, or its principal plane if
/// it has no surfaces [m].
Vec3d front_of(Setup const& setup) { return setup.camera_pose().point_to_outer({0, 0, paraxial_camera(setup).front}); }

/// The camera's axis; distances along it are measured from the lens' front, negative in front of it [m].
struct CameraAxis {
  Vec3d front, along;

  double meets(Vec3d point, Vec3d normal) const { return dot(point - front, normal) / dot(along, normal); }
  double meets_plane(double z) const { return meets({0, 0, z}, {0, 0, 1}); }
};

/// An object on the light path and its extent along the camera's axis.
struct OnTheWay {
  std::string name;
  double enters, leaves;               ///< positions on the axis of the object's two ends [m]
  std::optional<std::size_t> element;  ///< index of an optical element; empty: another object
};

/// Reports elements that are not between the lens and its image.
void check_elements_behind_lens(Setup const& setup, SetupTable const& root) {
  auto const is_behind = [](OpticalElement const& element) { return element.side() == ElementSide::sensor; };
  if (std::none_of(setup.elements.begin(), setup.elements.end(), is_behind)) return;
  Pose<double> const exit = lens_exit(setup);
  double to_image = dot(build_camera(setup).sensor.pose.origin - exit.origin, exit.z);
  for (OpticalElement const& element : setup.elements) to_image -= element.to_sensor();
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    OpticalElement const& element = setup.elements[i];
    if (!is_behind(element)) continue;
    double const z = element.pose().origin.z, half = element.thickness() / 2;
    if (z - half >= -touching && z + half <= to_image + touching) continue;
    element_tables(root)[i].table.problem(
        "position_mm",
        fmt::format("puts {} at {:.6g} mm behind the lens, but the image is {:.6g} mm behind it (with side = "
                    "\"sensor\", positions are relative to the last vertex of the lens); move it",
                    element_name(setup.elements, i), z / unit::millimetre, to_image / unit::millimetre));
  }
}

}  // namespace

void cross_check_geometry(Setup const& setup, SetupTable geometry) {
  std::optional<MediumEnds> const medium = medium_ends(setup);
  if (!medium) return;
  double const mm = unit::millimetre;
  if (setup.experiment().sources.on_target && -setup.z_d > medium->first) {
    geometry.problem("z_d_mm",
                     fmt::format("the dots lie {} the medium, which begins {:.6g} mm from its mid-plane; increase "
                                 "z_d_mm beyond {:.6g} or make the medium thinner{}",
                                 -setup.z_d < medium->last ? "inside" : "in front of", setup.medium.thickness / 2 / mm,
                                 -medium->first / mm, metres_hint(setup.z_d)));
  }
  if (double const front = front_of(setup).z; front < medium->last) {
    bool const by_vertex = geometry.has("z_front_mm");
    geometry.problem(
        by_vertex ? "z_front_mm" : "z_a_mm",
        fmt::format("the lens lies inside the medium, which ends {:.6g} mm from its mid-plane{}; increase "
                    "{} or make the medium thinner{}",
                    setup.medium.thickness / 2 / mm,
                    setup.lens.prescription ? fmt::format(" (its first vertex lies at Z = {:.6g} mm)", front / mm) : "",
                    by_vertex ? "z_front_mm" : "z_a_mm", metres_hint(setup.z_a)));
  }
}

void cross_check_elements(Setup const& setup, SetupTable const& root) {
  if (setup.elements.empty()) return;
  check_elements_behind_lens(setup, root);
  CameraAxis const axis{front_of(setup), setup.camera_pose().z};
  double const infinite = std::numeric_limits<double>::infinity();
  std::vector<OnTheWay> way;  // objects on the light path, in the required order
  if (setup.experiment().sources.on_target) {
    way.push_back({"the dots", axis.meets_plane(-setup.z_d), axis.meets_plane(-setup.z_d), {}});
  }
  for (ElementSide const side : {ElementSide::target, ElementSide::camera}) {
    for (std::size_t i = 0; i < setup.elements.size(); ++i) {
      OpticalElement const& element = setup.elements[i];
      if (element.side() != side) continue;
      Pose<double> const middle = element.pose();
      Vec3d const half = 0.5 * element.thickness() * middle.z;
      way.push_back({fmt::format("{} (side = \"{}\", Z = {:.6g} mm)", element_name(setup.elements, i),
                                 side == ElementSide::target ? "target" : "camera", middle.origin.z / unit::millimetre),
                     axis.meets(middle.origin - half, middle.z), axis.meets(middle.origin + half, middle.z), i});
    }
    if (auto const medium = medium_ends(setup); medium && side == ElementSide::target) {
      way.push_back({"the medium", axis.meets_plane(medium->first), axis.meets_plane(medium->last), {}});
    }
  }
  way.push_back({"the lens", 0, infinite, {}});
  OnTheWay const* last = &way.front();  // object that extends farthest so far
  for (OnTheWay const& next : way) {
    auto const element = next.element ? next.element : last->element;
    if (&next != last && next.enters < last->leaves - touching && element) {
      element_tables(root)[*element].table.problem(
          "side", fmt::format("light must pass {} and then {}, but along the camera's axis the latter begins {:.6g} "
                              "mm before the former ends; move one of them, or give the other side",
                              last->name, next.name, (last->leaves - next.enters) / unit::millimetre));
    }
    if (next.leaves > last->leaves) last = &next;
  }
}

}  // namespace gladstone::inline scene
