#include "render/scene/calibration_planes.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/base/units.h"
#include "render/scene/build_camera.h"

namespace gladstone::inline scene {
namespace {

constexpr double least_dot_px = 3;  // [px]; the centres of smaller dots depend on the pixel phase
constexpr double least_gap_px = 4;  // minimum gap between dots [px], to detect the background

}  // namespace

Setup plane_setup(Setup const& setup, double z) {
  Setup there = setup;
  there.camera.tilt = sensor_tilt(setup);
  there.camera.scheimpflug = false;
  there.lens.focus_distance = setup.focus_distance();
  there.lens.focus = Focus::distance;
  there.z_d = -z;
  there.render.method = RenderMethod::rays;
  return there;
}

std::optional<Pinhole> equivalent_pinhole(Setup const& setup, Camera const& camera) {
  bool const tilted = !(sensor_tilt(setup) == Vec2d{});
  bool const thin = !setup.lens.prescription && setup.elements.empty();
  if (!thin || (tilted && setup.camera.distorted())) return std::nullopt;
  PosedSensor<double> const& sensor = camera.sensor;
  Vec3d const to_sensor = sensor.pose.origin - camera.pose.origin;
  double const distance = dot(to_sensor, sensor.pose.z);
  Pinhole pinhole;
  pinhole.fx = pinhole.fy = distance / sensor.pitch;
  pinhole.cx = sensor.axis_pixel().x + dot(to_sensor, sensor.pose.x) / sensor.pitch;
  pinhole.cy = sensor.axis_pixel().y - dot(to_sensor, sensor.pose.y) / sensor.pitch;
  pinhole.brown = sensor.distortion;
  pinhole.rows = {sensor.pose.x, -sensor.pose.y, -sensor.pose.z};
  Vec3d const centre = camera.pose.origin;
  pinhole.translation = {-dot(pinhole.rows[0], centre), -dot(pinhole.rows[1], centre), -dot(pinhole.rows[2], centre)};
  return pinhole;
}

void cross_check_calibration(Setup const& setup, SetupTable root, Warnings& warnings) {
  SetupTable calibration = root.table("calibration");
  double const mm = unit::millimetre, nearest = *std::max_element(setup.planes.begin(), setup.planes.end());
  double const least = setup.lens.prescription ? 0.0 : setup.lens.focal_length;
  double const front = setup.lens.prescription ? paraxial_camera(setup).front : 0.0;  // first vertex of a prescription
  if (double const way = plane_setup(setup, nearest).z_b() + front; !(way > least)) {
    calibration.problem("planes_mm",
                        fmt::format("has the plane Z = {:.6g} mm, {:.6g} mm in front of the lens (within its focal "
                                    "length, or behind the lens: there is no image); move the planes or the camera",
                                    nearest / mm, way / mm));
  }
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    OpticalElement const& element = setup.elements[i];
    bool const ahead_of_lens = element.side() == ElementSide::target || element.side() == ElementSide::camera;
    double const z = element.pose().origin.z;
    if (!ahead_of_lens || z - element.thickness() / 2 > nearest) continue;
    calibration.problem("planes_mm",
                        fmt::format("has the plane Z = {:.6g} mm, but {} is at Z = {:.6g} mm (it must be between all "
                                    "planes and the camera); move the plane or the element",
                                    nearest / mm, element_name(setup.elements, i), z / mm));
  }
  double const px = setup.pixel_size(), diameter_px = setup.dot_diameter() / px;
  if (diameter_px < least_dot_px) {
    warnings.push_back(
        {WarningCode::unsuitable, "calibration.dot_diameter_mm",
         fmt::format(
             "dots are {:.2f} px wide in the image, too few to measure their centres accurately; use at least {} px",
             diameter_px, least_dot_px)});
  }
  if (double const gap_px = setup.target.spacing / px - diameter_px; gap_px < least_gap_px) {
    warnings.push_back({WarningCode::unsuitable, "calibration.spacing_mm",
                        fmt::format("dots are {:.2f} px apart in the image, edge to edge, but {} px are needed to "
                                    "separate them from the background; use a wider spacing",
                                    gap_px, least_gap_px)});
  }
}

}  // namespace gladstone::inline scene
