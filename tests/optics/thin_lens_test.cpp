#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "render/optics/camera_element.h"
#include "render/optics/lens_setup.h"

namespace gladstone {
namespace {

constexpr double f = 0.105;

/// Pose of an element on the axis, parallel to the XY plane.
Pose<double> on_axis(double z) {
  Pose<double> pose;
  pose.origin = {0, 0, z};
  return pose;
}

/// The lens of Table 1 at z = 0.75 m: 105 mm, f/11.
std::vector<CameraElement<double>> table1_lens() {
  return {PosedStop<double>{on_axis(0.75), f / 22, 0}, PosedThinLens<double>{on_axis(0.75), f}};
}

/// Traces a ray through elements until its weight is zero.
RayStatus carry(std::vector<CameraElement<double>> const& elements, Ray<double>& ray) {
  RayAccount<double> account{1, 0};
  for (auto const& element : elements) {
    RayStatus const status = pass_element(element, ray, account);
    if (account.weight == 0) return status;
  }
  return RayStatus::alive;
}

/// Returns the ray from a point to a point of the lens plane.
Ray<double> ray_between(Vec3d from, Vec2d pupil, double lens_z) {
  return {from, normalized(Vec3d{pupil.x - from.x, pupil.y - from.y, lens_z - from.z})};
}

std::vector<Vec2d> pupil_points(double radius) {
  std::vector<Vec2d> points{{0, 0}};
  for (int i = 0; i < 24; ++i) {
    double const angle = 0.3 + i, r = radius * std::sqrt((i + 0.5) / 24);
    points.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  return points;
}

/// Returns the intersection of the ray behind the lens with a plane.
Vec2d meets(Ray<double> const& ray, double z) {
  double const way = (z - ray.position.z) / ray.direction.z;
  return {ray.position.x + way * ray.direction.x, ray.position.y + way * ray.direction.y};
}

// 1/z_i = 1/f - 1/Z_B, M = z_i/Z_B = f/(Z_B - f), d_A = f/N; the digits are those of f = 105 mm, Z_B = 1 m, f/11.
TEST(ThinLensImaging, Table1Numbers) {
  ImagingGeometry const imaging = thin_lens_imaging(f, 11, 1.0, 1.0);
  EXPECT_NEAR(imaging.image_distance, 0.117318436, 5e-10);
  EXPECT_NEAR(imaging.magnification, 0.117318436, 5e-10);
  EXPECT_NEAR(imaging.magnification, f / (1.0 - f), 1e-16);
  EXPECT_NEAR(imaging.entrance_pupil, 9.545455e-3, 5e-10);
}

// If the lens is focused on the medium at 0.75 m, the sensor is at z_i = 1/(1/f - 1/0.75), and M = z_i/Z_B with that
// z_i.
TEST(ThinLensImaging, MagnificationTakesTheActualSensorDistanceWhenDefocused) {
  ImagingGeometry const imaging = thin_lens_imaging(f, 11, 0.75, 1.0);
  EXPECT_NEAR(imaging.image_distance, 0.105 * 0.75 / 0.645, 1e-16);
  EXPECT_NEAR(imaging.magnification, imaging.image_distance / 1.0, 1e-16);
}

TEST(ThinLensImaging, InfiniteFNumberHasNoPupil) {
  EXPECT_EQ(thin_lens_imaging(f, std::numeric_limits<double>::infinity(), 1.0, 1.0).entrance_pupil, 0.0);
}

// All rays of a point meet at -M X: the tolerance of 1e-15 m is ten roundings of a position of 1 cm after half a metre.
TEST(ThinLens, IsStigmaticOnAndOffTheAxis) {
  double const M = f / (1.0 - f), z_i = 1 / (1 / f - 1.0);
  for (Vec2d const X : {Vec2d{0, 0}, Vec2d{0.02, 0}, Vec2d{-0.03, 0.025}, Vec2d{0.1, -0.2}}) {
    for (Vec2d const pupil : pupil_points(f / 22)) {
      Ray<double> ray = ray_between({X.x, X.y, -0.25}, pupil, 0.75);
      ASSERT_EQ(carry(table1_lens(), ray), RayStatus::alive);
      EXPECT_NEAR(length(ray.direction), 1, 1e-15);
      Vec2d const image = meets(ray, 0.75 + z_i);
      EXPECT_NEAR(image.x, -M * X.x, 1e-15);
      EXPECT_NEAR(image.y, -M * X.y, 1e-15);
    }
  }
}

// A point whose sharp image is at z_i' is imaged by a sensor at z_i to a disc of diameter d_A |1 - z_i/z_i'| about the
// chief ray, which is a scaled image of the pupil.
TEST(ThinLens, ADefocusedPointIsADiscOfThePupilsShape) {
  double const sensor = f * 0.75 / (0.75 - f), sharp = f / (1.0 - f);
  double const scale = 1 - sensor / sharp;
  Vec3d const X{0.01, -0.005, -0.25};
  for (Vec2d const pupil : pupil_points(f / 22)) {
    Ray<double> ray = ray_between(X, pupil, 0.75);
    ASSERT_EQ(carry(table1_lens(), ray), RayStatus::alive);
    Vec2d const hit = meets(ray, 0.75 + sensor);
    EXPECT_NEAR(hit.x, -sensor * X.x + scale * pupil.x, 1e-15);
    EXPECT_NEAR(hit.y, -sensor * X.y + scale * pupil.y, 1e-15);
  }
  EXPECT_NEAR(f / 11 * std::abs(scale), 388.4e-6, 1e-7);  // 9.5455 mm times 4.070 %
}

// Parallel light of slope s is focused at s f in the focal plane.
TEST(ThinLens, ParallelRaysMeetInTheFocalPlane) {
  for (Vec2d const pupil : pupil_points(f / 22)) {
    Ray<double> ray{{pupil.x - 0.1 * 0.5, pupil.y, 0.25}, normalized(Vec3d{0.1, 0, 1})};
    ASSERT_EQ(carry(table1_lens(), ray), RayStatus::alive);
    EXPECT_NEAR(meets(ray, 0.75 + f).x, 0.1 * f, 1e-15);
    EXPECT_NEAR(meets(ray, 0.75 + f).y, 0, 1e-15);
  }
}

// Rays parallel to the axis keep their distance exactly: the last double inside the stop passes, the next does not.
TEST(PosedStop, StopsExactlyAtItsRadius) {
  PosedStop<double> const stop{on_axis(0.75), 0.004, 0};
  auto const status_at = [&](double x) {
    Ray<double> ray{{x, 0, 0}, {0, 0, 1}};
    RayAccount<double> account{1, 0};
    RayStatus const status = stop.interact(ray, account);
    EXPECT_EQ(account.weight, status == RayStatus::alive ? 1 : 0);
    return status;
  };
  EXPECT_EQ(status_at(0.004), RayStatus::alive);
  EXPECT_EQ(status_at(-0.004), RayStatus::alive);
  EXPECT_EQ(status_at(0.004 * (1 + 4e-16)), RayStatus::vignetted);
}

// The edge kernel has the moments 1, 0, 0, 0: the integral of a parabola in the enclosed area over the smoothed stop
// equals that over the sharp one.
TEST(ApertureStop, SmoothedEdgeIntegratesParabolasExactly) {
  ApertureStop<double> const smooth{1, 0.3};
  double sums[4] = {};
  int const n = 200000;
  for (int i = 0; i < n; ++i) {
    double const area = 1.3 * (i + 0.5) / n;
    double const share = smooth.transmission(std::sqrt(area), 0);
    for (int k = 0; k < 4; ++k) sums[k] += share * std::pow(area, k) * 1.3 / n;
  }
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(sums[k], 1.0 / (k + 1), 1e-9) << k;
}

TEST(ThinLens, WithoutAStopPassesEverything) {
  Ray<double> ray{{5, 0, 0}, {0, 0, 1}};
  RayAccount<double> account{1, 0};
  EXPECT_EQ((PosedThinLens<double>{on_axis(0.75), f}.interact(ray, account)), RayStatus::alive);
  EXPECT_EQ(account.weight, 1);
}

TEST(ThinLens, IsMissedByRaysThatRunAwayOrAlongIt) {
  for (double const dz : {0.0, -1.0}) {
    Ray<double> ray{{0, 0, 0}, normalized(Vec3d{1, 0, dz})};
    EXPECT_EQ(carry({PosedThinLens<double>{on_axis(0.75), f}}, ray), RayStatus::missed_lens);
  }
}

// A vignetted ray is not moved, but its intersection with the plane of the stop, from which the deflection at the stop
// is measured, can be found.
TEST(PosedStop, BlocksARayButFindsItsPlace) {
  PosedStop<double> const stop{on_axis(0.75), f / 22, 0};
  Ray<double> const sent = ray_between({0, 0, -0.25}, {0.02, 0.01}, 0.75);
  Ray<double> ray = sent;
  RayAccount<double> account{1, 0};
  EXPECT_EQ(stop.interact(ray, account), RayStatus::vignetted);
  EXPECT_EQ(account.weight, 0);
  EXPECT_EQ(ray.position, sent.position);
  Vec2d place;
  ASSERT_TRUE(stop.meet(ray, place));
  EXPECT_NEAR(place.x, 0.02, 1e-16);
  EXPECT_NEAR(place.y, 0.01, 1e-16);
}

}  // namespace
}  // namespace gladstone
