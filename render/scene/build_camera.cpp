#include "render/scene/build_camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/scene/best_focus.h"

namespace gladstone::inline scene {
namespace {

constexpr double sharp = 0;  // width of the smoothed edge of a stop; 0: sharp

/// Appends the surfaces of the optical elements on one side.
/// @param frame  frame of their poses, see ElementSide
void append_elements(Camera& camera, Setup const& setup, ElementSide side, Pose<double> const& frame) {
  bool const fresnel = setup.lens.transmittance != Transmittance::ideal;
  for (std::size_t i = 0; i < setup.elements.size(); ++i) {
    OpticalElement const& element = setup.elements[i];
    if (element.side() != side) continue;
    std::string const name = element_name(setup.elements, i);
    element.add_surfaces(element.pose().within(frame), fresnel,
                         [&](CameraElement<double> const& surface, std::string const& part) {
                           std::string full = name;
                           if (!part.empty()) full.append(", ").append(part);
                           camera.append(surface, full);
                         });
  }
}

void append_thin_lens(Camera& camera, Setup const& setup) {
  bool const chief = std::isinf(setup.lens.f_number);
  double const radius = chief ? std::numeric_limits<double>::infinity() : camera.paraxial.stop_radius;
  camera.stop = static_cast<int>(camera.elements.size());
  camera.stop_radius = camera.paraxial.stop_radius;
  camera.append(PosedStop<double>{camera.pose, radius, sharp}, "stop");
  camera.append(PosedThinLens<double>{camera.pose, setup.lens.focal_length}, "thin lens");
}

/// Appends the surfaces of a prescription. A plane stop without glass becomes a PosedStop, whose edge can be smoothed.
void append_prescription(Camera& camera, Setup const& setup) {
  Lens const& lens = *setup.lens.prescription;
  bool const chief = std::isinf(setup.lens.f_number);
  camera.stop = static_cast<int>(camera.elements.size()) + lens.stop;
  camera.stop_radius = chief ? 0 : lens.stop_radius;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    bool const stop = static_cast<int>(i) == lens.stop;
    auto const element = lens.surfaces[i].visit([&](auto surface) -> CameraElement<double> {
      surface.pose = surface.pose.within(camera.aim_plane);
      if (stop && chief) surface.semi_diameter = std::numeric_limits<double>::infinity();
      if constexpr (std::is_same_v<decltype(surface.shape), Quadric<double>>) {
        bool const plane = surface.is_plain_stop() && surface.shape.curvature == 0;
        if (stop && plane) return PosedStop<double>{surface.pose, surface.semi_diameter, sharp};
      }
      return surface;
    });
    camera.append(element, "surface " + std::to_string(i + 1));
  }
}

/// Appends the elements in the image plane, and places the sensor behind them.
void append_elements_of_image(Camera& camera, Setup const& setup) {
  append_elements(camera, setup, ElementSide::image_plane, camera.sensor.pose);
  for (OpticalElement const& element : setup.elements) {
    if (element.to_sensor() > 0) camera.sensor.pose = camera.sensor.pose.moved({0, 0, element.to_sensor()});
  }
}

/// Returns the tilt of the sensor that images a plane sharply everywhere (collinear map): the object plane z = -Z + a .
/// (x, y) has the image plane z' = z_i - M a . (x', y') [rad].
/// @param normal  normal of the object plane in the camera's frame
Vec2d scheimpflug_tilt(Vec3d normal, double magnification) {
  Vec2d const a{-normal.x / normal.z, -normal.y / normal.z};
  Vec3d const tilted = normalized(Vec3d{magnification * a.x, magnification * a.y, 1});
  return {std::atan2(-tilted.y, tilted.z), std::asin(tilted.x)};
}

/// Returns a pose whose z axis is along the light. @param forwards  -1: light travels along -z
Pose<double> along_light(Pose<double> const& pose, double forwards) {
  return forwards < 0 ? Pose<double>{pose.origin, -1.0 * pose.x, pose.y, -1.0 * pose.z} : pose;
}

/// Returns the point of the dots' plane that a pixel sees [m].
Vec2d seen_place(Camera const& camera, Setup const& setup, Vec2d pixel) {
  auto const seen = camera.unproject(pixel, Pose<double>{{0, 0, -setup.z_d}});
  if (!seen)
    throw DataError(ErrorCode::invalid_value, KeyPath{"camera.pose"},
                    "its field of view extends beyond the dots' plane; rotate the camera less");
  return seen->place;
}

}  // namespace

Vec2d sensor_tilt(Setup const& setup) {
  if (!setup.camera.scheimpflug) return setup.camera.tilt;
  return scheimpflug_tilt(setup.camera_pose().direction_to_local({0, 0, 1}), setup.imaging().magnification);
}

ParaxialCamera paraxial_camera(Setup const& setup) {
  ParaxialCamera paraxial;
  for (OpticalElement const& element : setup.elements) {
    if (element.side() != ElementSide::sensor) paraxial.window_shift += element.shift();
  }
  if (setup.lens.prescription) {
    Lens const& lens = *setup.lens.prescription;
    int const count = static_cast<int>(lens.paraxial.size());
    double const principal = paraxial_lens(lens).front_principal_plane;
    paraxial.front = std::isfinite(principal) ? -principal : 0;
    paraxial.to_stop = ray_transfer(lens, 0, lens.stop);
    paraxial.whole = ray_transfer(lens, 0, count);
    paraxial.forwards = lens.paraxial.back().n_after < 0 ? -1 : 1;
    paraxial.stop_radius = lens.paraxial_stop_radius;
    paraxial.behind = lens.poses.back().within(Pose<double>{{0, 0, paraxial.front}});
  } else {
    paraxial.whole.c = -1 / setup.lens.focal_length;
    paraxial.stop_radius = setup.lens.focal_length / setup.lens.f_number / 2;
  }
  if (std::isinf(setup.lens.f_number)) paraxial.stop_radius = 0;
  if (double const shift = setup.element_shift(ElementSide::sensor); shift > 0)
    paraxial.behind = paraxial.behind.moved({0, 0, paraxial.forwards * shift});
  return paraxial;
}

Pose<double> lens_exit(Setup const& setup) {
  Pose<double> const camera = setup.camera_pose();
  if (!setup.lens.prescription) return camera;
  ParaxialCamera const paraxial = paraxial_camera(setup);
  Pose<double> const last = setup.lens.prescription->poses.back().within(Pose<double>{{0, 0, paraxial.front}});
  return along_light(last, paraxial.forwards).within(camera);
}

ImagingGeometry paraxial_imaging(Setup const& setup, ParaxialCamera const& paraxial) {
  double const target = setup.z_b() + paraxial.front, shift = paraxial.window_shift;
  double const focus = setup.focus_distance() + paraxial.front - shift;
  RayTransfer const& m = paraxial.whole;
  double const image = -(m.a * focus + m.b) / (m.c * focus + m.d);  // distance of the image behind the last surface [m]
  double const slope = paraxial.chief_slope(target), height = 1 + slope * (target - shift);
  double const magnification = std::abs(m.a * height + m.b * slope + image * (m.c * height + m.d * slope));
  ImagingGeometry imaging;
  imaging.magnification = magnification;
  imaging.entrance_pupil = paraxial.stop_radius > 0 ? 2 * setup.z_b() * paraxial.marginal_slope(target) : 0;
  imaging.image_distance = paraxial.stop_radius > 0 ? imaging.entrance_pupil / (2 * paraxial.image_slope(target))
                                                    : magnification * setup.z_b();
  return imaging;
}

namespace {

/// Returns width and height, centred on target_centre(), of the dots' plane seen in a rectangle of the image [m].
/// @param first,last  opposite corners of the rectangle [px]
Vec2d seen_extent(Setup const& setup, Vec2d first, Vec2d last) {
  Camera const camera = build_camera(setup);
  Vec2d const centre = setup.target_centre();
  Vec2d half{};
  for (Vec2d const corner : {first, Vec2d{last.x, first.y}, Vec2d{first.x, last.y}, last}) {
    Vec2d const off = seen_place(camera, setup, corner) - centre;
    half = {std::max(half.x, std::abs(off.x)), std::max(half.y, std::abs(off.y))};
  }
  return 2.0 * half;
}

}  // namespace

Vec2d posed_view(Setup const& setup) {
  return seen_extent(setup, {-0.5, -0.5}, {setup.camera.columns - 0.5, setup.camera.rows - 0.5});
}

Vec2d posed_extent(Setup const& setup) {
  double const margin = setup.view_margin_px;
  Vec2d const seen =
      seen_extent(setup, {-margin, -margin}, {setup.camera.columns + margin, setup.camera.rows + margin});
  // Round up to whole micrometres, so that the resolved setup, which stores mm, reproduces the dots to the last bit.
  auto const in_mm = [](double metres) { return std::ceil(metres / unit::micrometre) * 1e-3; };
  return Vec2d{in_mm(seen.x), in_mm(seen.y)} * unit::millimetre;
}

double posed_pixel_size(Setup const& setup) {
  auto const seen = build_camera(setup).see(setup.target_centre(), Pose<double>{{0, 0, -setup.z_d}});
  double const area = seen ? std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x) : 0;  // [px^2/m^2]
  if (!(area > 0))
    throw DataError(ErrorCode::invalid_value, KeyPath{"camera.pose"},
                    "does not see the centre of the target; turn the camera towards it");
  return 1 / std::sqrt(area);
}

double posed_view_area(Setup const& setup) {
  constexpr int pieces = 4;  // number of segments per edge of the view, since distortion curves the edges
  Camera const camera = build_camera(setup);
  double const width = setup.camera.columns, height = setup.camera.rows;
  std::vector<Vec2d> outline;
  Vec2d const corners[] = {{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}};
  for (int k = 0; k < 4 * pieces; ++k) {
    Vec2d const from = corners[k / pieces], to = corners[k / pieces + 1];
    Vec2d const edge = from + (static_cast<double>(k % pieces) / pieces) * (to - from);
    outline.push_back(seen_place(camera, setup, edge - Vec2d{0.5, 0.5}));
  }
  double twice = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    Vec2d const a = outline[k] - outline[0], b = outline[(k + 1) % outline.size()] - outline[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

Camera build_camera(Setup const& setup) {
  Camera camera;
  camera.pose = setup.camera_pose();
  camera.paraxial = paraxial_camera(setup);
  ParaxialCamera const& paraxial = camera.paraxial;
  camera.aim_plane = camera.pose.moved({0, 0, paraxial.front});
  append_elements(camera, setup, ElementSide::target, {});
  camera.before_medium = static_cast<int>(camera.elements.size());
  append_elements(camera, setup, ElementSide::camera, {});
  camera.before_lens = static_cast<int>(camera.elements.size());
  setup.lens.prescription ? append_prescription(camera, setup) : append_thin_lens(camera, setup);
  append_elements(camera, setup, ElementSide::sensor, lens_exit(setup));
  double const pupil = paraxial.stop_radius / std::max(std::abs(paraxial.to_stop.a), 0.05);
  camera.aim_step = pupil > 0 ? 1e-4 * pupil : 1e-4 * unit::millimetre;

  bool const thin = !setup.lens.prescription;
  double const focus = setup.focus_distance() + paraxial.front - paraxial.window_shift;
  RayTransfer const& m = paraxial.whole;
  double image = -(m.a * focus + m.b) / (m.c * focus + m.d);
  if (thin && !setup.has_refracting_elements()) image = setup.imaging().image_distance;
  if (!(image > 0) || !std::isfinite(image)) {  // reduced distance t/n: mirrors reverse both signs
    throw DataError(ErrorCode::invalid_value, KeyPath{"lens"},
                    "the plane in focus has no real image behind it; check lens.focus and the geometry");
  }
  Pose<double> const behind = along_light(paraxial.behind, paraxial.forwards);
  double const along = image;
  camera.sensor = {behind.moved({0, 0, along}).within(camera.pose),
                   setup.camera.pixel_pitch,
                   setup.camera.columns,
                   setup.camera.rows,
                   setup.camera.distortion,
                   along};
  if ((!thin || setup.has_refracting_elements()) && !camera.chief_rays_only()) {
    Vec3d const point = camera.pose.origin - setup.focus_distance() * camera.pose.z;
    camera.sensor.pose = camera.sensor.pose.moved({0, 0, best_focus(camera, point)});
  }
  Vec2d const tilt = sensor_tilt(setup);
  camera.sensor.pose = camera.sensor.pose.turned({tilt.x, tilt.y, 0});
  append_elements_of_image(camera, setup);
  return camera;
}

}  // namespace gladstone::inline scene
