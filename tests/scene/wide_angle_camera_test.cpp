#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "render/base/units.h"
#include "render/optics/paraxial.h"
#include "render/rays/rays_launch.h"
#include "render/scene/build_camera.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// The fisheye lens of 170 degrees (focal length 0.205 mm, image circle 0.5 mm wide) at f/4 in front of dots at a
/// distance of 100 mm from its first vertex, on which it is focused.
Setup wide_setup(int pixels, double pitch) {
  Setup setup = table1_setup(pixels);
  setup.camera.pixel_pitch = pitch;
  LensOptions options;
  options.f_number = 4;
  auto const lens = std::make_shared<Lens const>(
      build_lens(read_prescription(GLADSTONE_DATA_DIR "/../tests/cases/lenses/wide_170.toml"),
                 GlassCatalogue::shipped(), setup.medium.wavelength, options));
  ParaxialLens const paraxial = paraxial_lens(*lens);
  setup.lens.prescription = lens;
  setup.lens.focal_length = paraxial.effective_focal_length;
  setup.lens.f_number = 4;
  setup.z_d = 0.05;
  // z_a is the distance to the front principal plane
  setup.z_a = 0.05 + paraxial.front_principal_plane;
  return setup;
}

struct ChiefRay {
  double degrees;  ///< angle under which the first vertex sees the point
  double y_mm;     ///< intersection of the chief ray with the plane of the last vertex
  double slope;    ///< slope of the chief ray there
};

// Reference values from an independent ray tracer in Python: rays started at the centre of the stop, traced backwards
// through the lens so that they pass the point (0, 100 mm tan(angle)), then through the whole lens.
constexpr ChiefRay listing[] = {{0, 0, 0},
                                {20, -0.029306102972631542, -0.048733846496671292},
                                {40, -0.056872352603961993, -0.094554229130358103},
                                {55, -0.075422034305192717, -0.12536459320985688},
                                {60, -0.081059251468444435, -0.13472257642472854},
                                {65, -0.086369444764250028, -0.14353498916102869},
                                {70, -0.09131218861807873, -0.15173501086545763},
                                {75, -0.095840942771175802, -0.15924581652301281},
                                {80, -0.09990497473382505, -0.16598377083714222}};

Vec3d point_at(double degrees, double turn = 0) {
  double const r = 0.1 * std::tan(degrees * unit::degree);
  return {-r * std::sin(turn), r * std::cos(turn), -0.05};
}

// Heights on the sensor, which is in the best focus at a known distance behind the last vertex: chief rays meet the
// stop's centre to 1e-10 of its radius (0.16 mm), 1e-7 px of 1 um.
TEST(WideAngleCamera, ProjectsToEightyDegreesAsAnIndependentTracer) {
  auto const setup = wide_setup(513, 1e-6);
  Camera const camera = build_camera(setup);
  Vec3d const last = camera.elements.back().visit([](auto const& held) { return held.pose.origin; });
  double const behind = dot(camera.sensor.pose.origin - last, camera.pose.z);
  for (auto const& [degrees, y_mm, slope] : listing) {
    double const height_px = std::abs(y_mm * 1e-3 + slope * behind) / 1e-6;
    for (double const turn : {0.0, 2.2}) {
      auto const pixel = camera.project(point_at(degrees, turn));
      ASSERT_TRUE(pixel) << degrees;
      EXPECT_NEAR(pixel->x, 256 - height_px * std::sin(turn), 1e-6) << degrees;
      EXPECT_NEAR(pixel->y, 256 - height_px * std::cos(turn), 1e-6) << degrees;
    }
  }
}

// unproject() is the inverse of project(), and its derivatives are those of project(). They are central differences
// over a pixel on the axis, 0.5 mm here, whose rays pass the pupil (0.03 mm) 5 um from its centre. With (5/30)^2 times
// a tenth, the contribution of aberrations, the error is 3e-3.
TEST(WideAngleCamera, UnprojectsWhatItProjects) {
  auto const setup = wide_setup(513, 1e-6);
  Camera const camera = build_camera(setup);
  Pose<double> const plane{{0, 0, -0.05}};
  for (ChiefRay const& row : listing) {
    Vec3d const point = point_at(row.degrees, 0.7);
    auto const pixel = camera.project(point);
    ASSERT_TRUE(pixel) << row.degrees;
    auto const seen = camera.unproject(*pixel, plane);
    ASSERT_TRUE(seen) << row.degrees;
    // solved to 1e-6 px; a pixel at this position sees 100 mm / (205 px cos^2): 16 mm at 80 degrees
    EXPECT_NEAR(length(seen->place - Vec2d{point.x, point.y}), 0, 2e-8) << row.degrees;
    double const h = 1e-5;
    auto const right = camera.project(point + Vec3d{h, 0, 0}), left = camera.project(point - Vec3d{h, 0, 0});
    ASSERT_TRUE(right && left) << row.degrees;
    Vec2d const slope = (*right - *left) / (2 * h);
    EXPECT_NEAR(length(seen->by_x - slope), 0, 5e-3 * length(slope)) << row.degrees;
  }
}

// No ray that passes the stop crosses the aim plane outside of the entrance pupil as seen from the source.
TEST(WideAngleCamera, SourcesSeeTheWholeStop) {
  Camera const camera = build_camera(wide_setup(65, 8e-6));
  for (double const degrees : {0.0, 45.0, 60.0, 70.0, 80.0}) {
    Vec3d const point = point_at(degrees, 1.1);
    auto const disc = camera.apparent_pupil(point);
    ASSERT_TRUE(disc) << degrees;
    int passed = 0, outside = 0, within = 0;
    constexpr int half = 60;
    for (int i = -half; i <= half; ++i)
      for (int j = -half; j <= half; ++j) {
        Vec2d const at{2.0 * i / half, 2.0 * j / half};
        Vec3d const aim = disc->centre + at.x * disc->a + at.y * disc->b;
        RayHit<double> const hit = trace_ray(camera.view(), NoMedium<double>{}, TracingOptions<double>{},
                                             Ray<double>{point, normalized(aim - point)}, 1.0);
        bool const inside = length(at) <= 1, passes = reaches_sensor_plane(hit.status);
        within += inside ? 1 : 0;
        passed += passes ? 1 : 0;
        outside += passes && !inside ? 1 : 0;
      }
    EXPECT_EQ(outside, 0) << degrees;
    EXPECT_GT(passed, 0.8 * within) << degrees;
  }
}

// Dots at 0, 40 and 60 degrees are rendered at the positions of project(): the centroid differs from the chief ray only
// by the coma of the lens, less than a tenth of its spot, which is at most some pixels of 8 um.
TEST(WideAngleRendering, ShowsDotsAtTheRimOfTheField) {
  auto setup = wide_setup(36, 8e-6);  // corners at 0.204 mm, 63 degrees
  setup.target.dots_per_32px_window = 1;
  PlannedScene scene(build_scene(setup));
  scene.dots.centre.clear();
  for (double const degrees : {0.0, 40.0, 60.0}) {
    Vec3d const point = point_at(degrees, 0.25 * pi);
    scene.dots.centre.push_back({point.x, point.y});
  }
  scene.dots.half_size = 1e-6;
  plan_step(scene);
  scene.plan.rays = 1024;
  Rendering const result = RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
  for (std::size_t dot = 0; dot < 3; ++dot) {
    auto const pixel = scene.camera.project({scene.dots.centre[dot].x, scene.dots.centre[dot].y, -setup.z_d});
    ASSERT_TRUE(pixel);
    EXPECT_GT(result.truth.rays[dot][0], 500) << dot;
    EXPECT_NEAR(length(result.truth.reference_px[dot] - *pixel), 0, 0.3) << dot;
    EXPECT_EQ(result.truth.displacement_px[dot], Vec2d{}) << "no displacement without a medium";
  }
}

/// Renders dots of one size at the listed angles from the axis, with 4096 rays each.
Rendering render_dots(PlannedScene scene, std::vector<double> const& degrees, double half_size) {
  scene.dots.centre.clear();
  for (double const angle : degrees) {
    Vec3d const point = point_at(angle, 0.25 * pi);
    scene.dots.centre.push_back({point.x, point.y});
  }
  scene.dots.half_size = half_size;
  plan_step(scene);
  scene.plan.rays = 4096;
  return RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
}

// Dots of 3 mm are 30 times as wide as the pupil. Each of their rays is directed at the pupil as seen from its own
// start point, so that nearly as many rays pass as for a point, nine tenths on the axis; the others are in the margin
// of the target area. The light per area differs from that of the centre by the curvature of the cos^4 law over the
// dot, at most (1.5 mm / 100 mm)^2 times a factor of order 1; 4096 Sobol points add an error of about 0.2 %.
TEST(WideAngleRendering, DotsLargerThanThePupilLoseNoRays) {
  auto setup = wide_setup(65, 8e-6);
  setup.target.dots_per_32px_window = 1;
  PlannedScene scene(build_scene(setup));
  std::vector<double> const degrees{0, 40, 70};
  constexpr double point = 1e-9, large = 1.5e-3;
  Rendering const points = render_dots(scene, degrees, point), dots = render_dots(scene, degrees, large);
  for (std::size_t dot = 0; dot < degrees.size(); ++dot) {
    auto const alive = static_cast<double>(dots.truth.rays[dot][0]);
    EXPECT_GT(alive, 0.8 * 4096) << degrees[dot];
    EXPECT_GT(alive, 0.95 * static_cast<double>(points.truth.rays[dot][0])) << degrees[dot];
    double const larger = (large * large) / (point * point);
    EXPECT_NEAR(dots.truth.flux[dot].x / (larger * points.truth.flux[dot].x), 1, 0.01) << degrees[dot];
    EXPECT_NEAR(length(dots.truth.reference_px[dot] - points.truth.reference_px[dot]), 0, 0.02) << degrees[dot];
    EXPECT_TRUE(std::isfinite(dots.truth.eq9_cone_px[dot].x)) << degrees[dot];
  }
  // A pixel on the axis that is filled by its dot is fully lit.
  auto const seen = scene.camera.see({}, scene.target_plane());
  ASSERT_TRUE(seen);
  double const pixels = pi * large * large * std::abs(seen->by_x.x * seen->by_y.y - seen->by_x.y * seen->by_y.x);
  EXPECT_NEAR(dots.truth.flux[0].x / pixels, 1, 0.02);
}

// No ray from the rim of a dot of 10 mm passes the stop outside of its target area.
TEST(WideAngleRendering, TargetAreasOfLargeDotsHoldTheWholeStop) {
  auto setup = wide_setup(65, 8e-6);
  setup.target.dots_per_32px_window = 1;
  PlannedScene scene(build_scene(setup));
  scene.plan.rays = 4096;
  RaysLaunch const launch(scene, scene.plan, SpotView{}, StopRim::sharp);
  constexpr double reach = 5e-3;
  for (double const degrees : {0.0, 45.0, 70.0}) {
    Vec3d const middle = point_at(degrees, 1.1);
    auto const disc = launch.sight(middle);
    ASSERT_TRUE(disc) << degrees;
    AimShift const shift = launch.aim_shift(*disc, middle, reach);
    EXPECT_LT(shift.residual, 0.2 * length(disc->a)) << degrees;
    AimedBundle<double> const bundle = launch.bundle(*disc, shift, 0);
    int passed = 0, outside = 0;
    for (double const turn : {0.0, 0.7, 1.6, 2.9, 3.8, 5.4}) {
      Vec3d const offset{reach * std::cos(turn), reach * std::sin(turn), 0};
      Vec3d const start = middle + offset;
      constexpr int half = 30;
      for (int i = -half; i <= half; ++i)
        for (int j = -half; j <= half; ++j) {
          Vec2d const at{2.0 * i / half, 2.0 * j / half};
          Vec3d const aim =
              bundle.centre + at.x * bundle.a + at.y * bundle.b + offset.x * bundle.by_x + offset.y * bundle.by_y;
          RayHit<double> const hit = trace_ray(launch.camera.view(), NoMedium<double>{}, TracingOptions<double>{},
                                               Ray<double>{start, normalized(aim - start)}, 1.0);
          passed += reaches_sensor_plane(hit.status) ? 1 : 0;
          outside += reaches_sensor_plane(hit.status) && length(at) > 1 ? 1 : 0;
        }
    }
    EXPECT_GT(passed, 1000) << degrees;
    EXPECT_EQ(outside, 0) << degrees;
  }
}

// Rays of sources up to as large as the pupil are sent to the pupil as seen from the source's centre, enlarged by the
// source's size.
TEST(WideAngleRendering, SmallSourcesAimAtThePupilSeenFromTheirMiddle) {
  auto setup = wide_setup(65, 8e-6);
  setup.target.dots_per_32px_window = 1;
  PlannedScene const scene(build_scene(setup));
  RaysLaunch const launch(scene, scene.plan, SpotView{}, StopRim::sharp);
  Vec3d const middle = point_at(40, 1.1);
  auto const disc = launch.sight(middle);
  ASSERT_TRUE(disc);
  double const larger = std::max(length(disc->a), length(disc->b));
  double const area = length(cross(disc->a, disc->b));
  double const below = 0.99 * area / std::hypot(length(disc->a), length(disc->b));  // smaller than either semi-axis
  AimShift const small = launch.aim_shift(*disc, middle, below);
  EXPECT_EQ(small.by_x, Vec3d{});
  EXPECT_EQ(small.by_y, Vec3d{});
  EXPECT_EQ(small.residual, below);
  AimShift const large = launch.aim_shift(*disc, middle, 2 * larger);
  EXPECT_GT(length(large.by_x), 0);
  EXPECT_LT(large.residual, 0.05 * larger);
}

}  // namespace
}  // namespace gladstone
