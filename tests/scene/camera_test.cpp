#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

Pose<double> dots_plane(Setup const& setup) { return {{0, 0, -setup.z_d}}; }

// A thin lens in focus maps (X, Y) to M (X, Y) / p from the axis pixel, columns to the right and rows downwards, M = f
// / (Z_B - f).
TEST(ThinCamera, ProjectsByTheMagnification) {
  auto const setup = table1_setup(512);
  Camera const camera = build_camera(setup);
  double const M = 105.0 / 895.0, scale = M / setup.camera.pixel_pitch;
  for (Vec2d const at : {Vec2d{0, 0}, {0.01, 0.002}, {-0.02, 0.015}}) {
    auto const pixel = camera.project({at.x, at.y, -setup.z_d});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, 255.5 + scale * at.x, 1e-9);
    EXPECT_NEAR(pixel->y, 255.5 - scale * at.y, 1e-9);
    auto const back = camera.unproject(*pixel, dots_plane(setup));
    ASSERT_TRUE(back);
    EXPECT_NEAR(length(back->place - at), 0, 1e-12);
    // central differences of a linear map over a pixel: rounding of 1e-13 px in steps of 1e-4 m
    EXPECT_NEAR(back->by_x.x / scale, 1, 1e-7);
    EXPECT_NEAR(back->by_y.y / scale, -1, 1e-7);
    EXPECT_NEAR(back->by_x.y / scale, 0, 1e-7);
    Vec2d const ideal = camera.ideal_project({at.x, at.y, -setup.z_d});
    EXPECT_NEAR(length(ideal - *pixel), 0, 1e-9);
  }
}

TEST(ThinCamera, SourcesSeeItsStopAsItIs) {
  auto const setup = table1_setup(64);
  Camera const camera = build_camera(setup);
  auto const disc = camera.apparent_pupil({0.01, -0.02, -setup.z_d});
  ASSERT_TRUE(disc);
  double const radius = 0.105 / 11 / 2;
  EXPECT_NEAR(length(disc->centre - Vec3d{0, 0, 0.75}), 0, 1e-12);
  // as wide as the stop, plus at most the safety margin for the number of rim points
  EXPECT_GE(length(disc->a) / radius, 1);
  EXPECT_LT(length(disc->a) / radius, 1.02);
  EXPECT_NEAR(length(disc->a), length(disc->b), 1e-12);
}

// A camera with a pose images a point like a camera without pose images the rotated point, with (R x - position) in
// place of x.
TEST(PosedCamera, SeesAsTheTurnedWorldIsSeen) {
  auto straight = table1_setup(512);
  straight.lens.focus = Focus::distance;
  straight.lens.focus_distance = 1;
  auto posed = straight;
  posed.pose = Pose<double>{{0.3, 0.1, 0.7}}.turned({0.1, 0.4, -0.2});
  posed.z_a = posed.pose->origin.z / posed.pose->z.z;
  Camera const camera = build_camera(posed), other = build_camera(straight);
  Pose<double> const standing{{0, 0, 0.75}};
  for (Vec3d const point : {Vec3d{0.01, 0.02, -0.1}, {-0.05, 0.0, 0.05}, {0, -0.03, -0.25}}) {
    auto const seen = camera.project(point);
    auto const expected = other.project(standing.point_to_outer(posed.pose->point_to_local(point)));
    ASSERT_TRUE(seen && expected);
    EXPECT_NEAR(length(*seen - *expected), 0, 1e-8);
  }
}

// The image of a point out of focus is centred on that of its chief ray, which passes the lens' centre undeflected. The
// camera is a pinhole there, whose image plane is that of the sensor, tilted or not.
TEST(PosedCamera, IsAPinholeThroughTheLensCentre) {
  auto setup = table1_setup(512);
  setup.camera.tilt = {2 * unit::degree, -3 * unit::degree};
  Camera const camera = build_camera(setup);
  Pose<double> const sensor =
      Pose<double>{{0, 0, 0.75 + setup.imaging().image_distance}}.turned({setup.camera.tilt.x, setup.camera.tilt.y, 0});
  for (Vec3d const point : {Vec3d{0.01, 0.012, -0.25}, {-0.02, 0.005, 0.1}}) {
    Ray<double> const through = sensor.inwards({point, Vec3d{0, 0, 0.75} - point});
    double const way = -through.position.z / through.direction.z;
    Vec2d const expected{255.5 - (through.position.x + way * through.direction.x) / setup.camera.pixel_pitch,
                         255.5 + (through.position.y + way * through.direction.y) / setup.camera.pixel_pitch};
    EXPECT_NEAR(length(*camera.project(point) - expected), 0, 1e-8);
  }
}

// Scheimpflug: if the sensor is in the image plane of a tilted object plane, every point of that plane has a sharp
// image, formed by rays through the rim of the stop as by the chief ray.
TEST(PosedCamera, ScheimpflugIsSharpAllOverThePlane) {
  auto setup = table1_setup(512);
  setup.lens.f_number = 2.8;
  setup.pose = Pose<double>{{0.4, 0.2, 0.8}};
  setup.pose->z = normalized(setup.pose->origin);
  setup.pose->x = normalized(cross(Vec3d{0, 1, 0}, setup.pose->z));
  setup.pose->y = cross(setup.pose->z, setup.pose->x);
  setup.z_a = setup.pose->origin.z / setup.pose->z.z;
  setup.camera.scheimpflug = true;
  Camera const camera = build_camera(setup);
  Vec2d const centre = setup.target_centre();
  setup.camera.scheimpflug = false;
  Camera const square = build_camera(setup);
  auto const blur = [&](Camera const& of, Vec3d point) {
    auto const disc = of.apparent_pupil(point);
    double widest = 0;
    Vec2d const chief = *of.project(point);
    for (Vec3d const rim : {disc->a, disc->b, -1.0 * disc->a, -1.0 * disc->b}) {
      Ray<double> const ray{point, normalized(disc->centre + 0.98 * rim - point)};
      RayHit<double> const hit = trace_ray(of.view(), NoMedium<double>{}, TracingOptions<double>{}, ray, 1.0);
      widest = std::max(widest, length(hit.pixel - chief));
    }
    return widest;
  };
  double without_tilt = 0;
  for (Vec2d const at : {Vec2d{0, 0}, {0.02, 0.0}, {-0.015, 0.02}, {0.01, -0.02}}) {
    Vec3d const point{centre.x + at.x, centre.y + at.y, -setup.z_d};
    EXPECT_LT(blur(camera, point), 1e-7);
    without_tilt = std::max(without_tilt, blur(square, point));
  }
  EXPECT_GT(without_tilt, 0.3) << "blur [px] on a sensor perpendicular to the axis";
}

/// Returns a camera rotated by 45 degrees about Y, 1 m from the intersection of its axis with the dots' plane; the
/// sensor is perpendicular to the axis, or in the image plane of the dots' plane.
Setup at_45_degrees(bool scheimpflug) {
  auto setup = table1_setup(512);
  Vec3d const middle{0, 0, -setup.z_d}, along = normalized(Vec3d{1, 0, 1});
  setup.pose = Pose<double>{middle + along, normalized(Vec3d{1, 0, -1}), {0, 1, 0}, along};
  setup.z_a = setup.pose->origin.z / setup.pose->z.z;
  setup.camera.scheimpflug = scheimpflug;
  return setup;
}

/// Returns the image area of a disc about the centre of the target, as a polygon with 360 corners [px^2].
double image_area(Setup const& setup, double diameter) {
  Camera const camera = build_camera(setup);
  Vec2d const middle = setup.target_centre();
  std::vector<Vec2d> rim;
  for (int k = 0; k < 360; ++k) {
    double const angle = k * unit::degree;
    rim.push_back(*camera.project(
        {middle.x + diameter / 2 * std::cos(angle), middle.y + diameter / 2 * std::sin(angle), -setup.z_d}));
  }
  double twice = 0;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    Vec2d const a = rim[k] - rim[0], b = rim[(k + 1) % rim.size()] - rim[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return std::abs(twice) / 2;
}

// Near the axis, the magnification is M = f / (Z - f) across the tilt. Along it, it is M cos(45) on a sensor
// perpendicular to the axis, and that over cos(phi), tan(phi) = M tan(45), on one in the image plane (Scheimpflug). The
// pixel size is the pitch over the geometric mean of both. The polygon is 5e-5 smaller than its circle.
TEST(PosedCamera, SizesOfDotsInPixelsAreThoseOfTheirImages) {
  for (bool const scheimpflug : {false, true}) {
    auto setup = at_45_degrees(scheimpflug);
    double const M = 105.0 / 895.0, phi = scheimpflug ? std::atan(M) : 0.0;
    double const across = M, along = M * std::cos(45 * unit::degree) / std::cos(phi);
    EXPECT_NEAR(setup.pixel_size() / (setup.camera.pixel_pitch / std::sqrt(across * along)), 1, 1e-6) << scheimpflug;
    setup.target.dot_diameter_px = 4;
    EXPECT_NEAR(image_area(setup, setup.dot_diameter()) / (pi * 4), 1, 1e-4) << scheimpflug;
    EXPECT_EQ(2 * build_scene(setup).dots.half_size, setup.dot_diameter()) << scheimpflug;
    // repeat the check for a target with another centre
    setup.target.centre_m = Vec2d{0.01, 0.005};
    EXPECT_NEAR(image_area(setup, setup.dot_diameter()) / (pi * 4), 1, 1e-4) << scheimpflug;
  }
}

// OpenCV's formula, applied to (x, y) / z_i with x to the right and y down.
TEST(PosedCamera, DistortsAsBrownSays) {
  auto setup = table1_setup(512);
  Camera const plain = build_camera(setup);
  setup.camera.distortion = {-2.0, 10.0, 0.03, -0.05};
  Camera const camera = build_camera(setup);
  double const z = setup.imaging().image_distance / setup.camera.pixel_pitch;  // [px]
  for (Vec3d const point : {Vec3d{0.015, 0.01, -0.25}, {-0.02, 0.02, -0.25}}) {
    Vec2d const u = *plain.project(point) - Vec2d{255.5, 255.5};
    double const x = u.x / z, y = u.y / z, r2 = x * x + y * y, radial = 1 - 2.0 * r2 + 10.0 * r2 * r2;
    Vec2d const expected{x * radial + 2 * 0.03 * x * y - 0.05 * (r2 + 2 * x * x),
                         y * radial + 0.03 * (r2 + 2 * y * y) + 2 * -0.05 * x * y};
    EXPECT_NEAR(length(*camera.project(point) - Vec2d{255.5, 255.5} - z * expected), 0, 1e-8);
    auto const back = camera.unproject(*camera.project(point), dots_plane(setup));
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->place.x, point.x, 1e-10);
  }
}

// A plane plate displaces a ray by t sin(a) (1 - cos(a) / sqrt(n^2 - sin(a)^2)) perpendicular to it, whatever is behind
// the plate. For rays near its normal, it shifts the dots towards the camera by t (1 - 1/n).
TEST(Window, ActsAsThePlanePlate) {
  auto setup = table1_setup(512);
  OpticalWindow window;
  window.index = 1.5168;
  window.thickness = 10e-3;
  window.position = {0, 0, 0.1};
  setup.elements = {window};
  // a small aperture, so that the plate's spherical aberration does not change the best focus
  setup.lens.f_number = 64;
  auto bare = setup;
  bare.elements.clear();
  bare.z_d -= window.shift();
  EXPECT_NEAR(window.shift(), 3.40717299578059e-3, 1e-12);
  EXPECT_NEAR(setup.imaging().magnification, bare.imaging().magnification, 1e-12);
  Camera const camera = build_camera(setup), nearer = build_camera(bare);
  Vec2d const seen = *camera.project({1e-3, 2e-3, -setup.z_d}), expected = *nearer.project({1e-3, 2e-3, -bare.z_d});
  EXPECT_NEAR(length(seen - expected), 0, 1e-4);

  // tilted by 30 degrees: 1.97621122205116 mm perpendicular to the ray along the axis
  window.tilt = {0, 30 * unit::degree};
  setup.elements = {window};
  Camera const tilted = build_camera(setup);
  Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
  RayAccount<double> account;
  EXPECT_EQ(carry(tilted.view(), 0, 2, ray, account), RayStatus::alive);
  EXPECT_NEAR(length(Vec2d{ray.position.x, ray.position.y}), 1.97621122205116e-3, 1e-12);
  EXPECT_NEAR(ray.direction.z, 1, 1e-15);
}

// The double Gauss in place of Table 1's lens: near the axis it equals a thin lens of its focal length at its front
// principal plane; farther out it distorts. Its chief rays pass the centre of the entrance pupil.
TEST(PrescribedCamera, IsPlacedByItsFrontPrincipalPlane) {
  auto const setup = double_gauss_setup(512);
  Camera const camera = build_camera(setup);
  double const f = setup.lens.focal_length, M = f / (1 - f);
  EXPECT_NEAR(setup.imaging().magnification, M, 1e-9);
  auto const seen = camera.unproject({255.5, 255.5}, dots_plane(setup));
  ASSERT_TRUE(seen);
  EXPECT_NEAR(length(seen->place), 0, 1e-9);
  // the sensor is at the best focus, not at the paraxial one: a difference of about 0.01 mm in 112 mm
  EXPECT_NEAR(seen->by_x.x * setup.camera.pixel_pitch / M, 1, 1e-3);
  Vec3d const corner{0.02, 0.02, -setup.z_d};
  Vec2d const ideal = camera.ideal_project(corner), real = *camera.project(corner);
  EXPECT_GT(length(real - ideal), 1e-3);
  EXPECT_LT(length(real - ideal), 1.0);
  // near the axis, distortion is proportional to the cube of the field angle
  Vec3d const near{0.002, 0.002, -setup.z_d};
  EXPECT_LT(length(*camera.project(near) - camera.ideal_project(near)), 2e-3 * length(real - ideal));
}

// At the best focus, moving the sensor in either direction widens the axial bundle.
TEST(PrescribedCamera, IsFocusedWhereTheAxialBundleIsNarrowest) {
  auto const setup = double_gauss_setup(64, 2.8);
  Camera camera = build_camera(setup);
  Vec3d const point{0, 0, -setup.z_d};
  auto const disc = camera.apparent_pupil(point);
  ASSERT_TRUE(disc);
  auto const width = [&](double moved) {
    Camera other = camera;
    other.sensor.pose = other.sensor.pose.moved({0, 0, moved});
    double sum = 0;
    int count = 0;
    for (int i = 0; i < 4000; ++i) {
      double const r = std::sqrt((i + 0.5) / 4000), a = i * pi * (3 - std::sqrt(5.0));
      Vec3d const aim = disc->centre + r * std::cos(a) * disc->a + r * std::sin(a) * disc->b;
      RayHit<double> const hit = trace_ray(other.view(), NoMedium<double>{}, TracingOptions<double>{},
                                           Ray<double>{point, normalized(aim - point)}, 1.0);
      if (!reaches_sensor_plane(hit.status)) continue;
      sum += dot(hit.pixel - other.sensor.axis_pixel(), hit.pixel - other.sensor.axis_pixel());
      ++count;
    }
    return std::sqrt(sum / count);
  };
  double const best = width(0);
  EXPECT_GT(width(20e-6), 1.005 * best);
  EXPECT_GT(width(-20e-6), 1.005 * best);
}

}  // namespace
}  // namespace gladstone
