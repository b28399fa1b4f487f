#include "render/medium/ray_equation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"
#include "studies/oracles/oracle_media.h"

namespace gladstone {
namespace {

using oracle::FishEye;
using oracle::LinearSquaredIndex;
using oracle::LuneburgSphere;
using oracle::ParabolicRod;

struct Path {
  RayState<double> end;
  double optical_path = 0;
};

/// Integrates a ray by N equal steps over the parameter t.
template <class Medium>
Path walk(Medium const& medium, RayState<double> ray, double t, int steps, Integrator integrator = Integrator::rk4) {
  Path path{ray};
  double const dt = t / steps;
  for (int i = 0; i < steps; ++i) {
    path.optical_path +=
        step_increment(medium, integrator, path.end.position, path.end.optical_direction, dt).optical_path;
    path.end = advance(medium, path.end, dt, integrator);
  }
  return path;
}

/// Returns a meridional ray in the x-z plane, at (x, z), with an angle to the z axis.
template <class Medium>
RayState<double> launch(Medium const& medium, double x, double z, double angle) {
  Vec3d const at{x, 0, z};
  double const n = 1 + medium.sample(at).refractivity;
  return {at, {n * std::sin(angle), 0, n * std::cos(angle)}};
}

// If n^2 is linear, n grad n is constant, and the scheme integrates a constant force exactly: a single step must
// reproduce the parabola up to rounding.
TEST(LinearSquaredIndexMedium, OneStepIsExact) {
  LinearSquaredIndex const medium;
  RayState<double> const end = advance(medium, launch(medium, 0, 0, 10 * unit::degree), 5.0);
  EXPECT_NEAR(end.position.x, 1.11824088833465, 1e-13);
  EXPECT_NEAR(end.position.z, 4.92403876506104, 1e-13);
  EXPECT_NEAR(end.optical_direction.x, 0.27364817766693, 1e-13);
  EXPECT_EQ(end.position.y, 0);
}

TEST(LinearSquaredIndexMedium, OpticalPathIsCubicInT) {
  // n^2 along the parabola is quadratic in t, which Simpson's rule integrates exactly
  LinearSquaredIndex const medium;
  double const t = 5, px = std::sin(10 * unit::degree), a = medium.a;
  double const exact = t + 2 * a * (px * t * t / 2 + a * t * t * t / 6);
  EXPECT_NEAR(walk(medium, launch(medium, 0, 0, 10 * unit::degree), t, 1).optical_path, exact, 1e-13);
}

double rod_error(int steps, Integrator integrator) {
  ParabolicRod const rod;
  RayState<double> const start = launch(rod, 1, 0, 0);
  double const t = rod.length / start.optical_direction.z;
  return std::abs(walk(rod, start, t, steps, integrator).end.position.x - -0.425287303350492);
}

// Errors of the scheme at z = 20 mm, computed independently: they determine the scheme, not only its order.
TEST(ParabolicRod, RungeKuttaIsOfOrderFour) {
  double const printed[] = {1.612e-4, 9.723e-6, 5.946e-7, 3.672e-8, 2.281e-9};
  double before = 0;
  for (int i = 0; i < 5; ++i) {
    double const error = rod_error(5 << i, Integrator::rk4);
    EXPECT_NEAR(error / printed[i], 1, 1e-3) << (5 << i) << " steps";
    if (i > 0) {
      EXPECT_GT(before / error, 15);
      EXPECT_LT(before / error, 17.5);
    }
    before = error;
  }
}

TEST(ParabolicRod, EulerIsOfOrderOne) {
  double const ratio = rod_error(2000, Integrator::euler) / rod_error(4000, Integrator::euler);
  EXPECT_NEAR(ratio, 2, 0.05);
}

// |T| = n along every ray (eikonal equation): |T|^2 - n^2 decreases with the order of the scheme.
TEST(ParabolicRod, OpticalDirectionKeepsTheLengthOfTheIndex) {
  ParabolicRod const rod;
  RayState<double> const start = launch(rod, 0.5, 0, 5 * unit::degree);
  double const t = rod.length / start.optical_direction.z;
  double before = 0;
  for (int steps = 10; steps <= 160; steps *= 2) {
    RayState<double> const end = walk(rod, start, t, steps).end;
    double const drift = std::abs(dot(end.optical_direction, end.optical_direction) - rod.squared_index(end.position));
    if (before > 0) {
      EXPECT_GT(before / drift, 14);
    }
    before = drift;
  }
  EXPECT_LT(before, 1e-9);
}

// The paraxial period is 2 pi / g = 62.83 mm; the exact one depends on the initial direction: 2 pi p_z / (n0 g).
TEST(ParabolicRod, RayReturnsAfterItsExactPeriod) {
  ParabolicRod const rod;
  RayState<double> const start = launch(rod, 1, 0, 0);
  RayState<double> const end = walk(rod, start, 62.5169044565659 / start.optical_direction.z, 2000).end;
  EXPECT_NEAR(end.position.x, 1, 1e-10);
  EXPECT_NEAR(end.position.z, 62.5169044565659, 1e-11);
  EXPECT_NEAR(end.optical_direction.x, 0, 1e-10);
}

class Luneburg : public testing::TestWithParam<double> {};

TEST_P(Luneburg, ParallelRaysMeetAtThePole) {
  LuneburgSphere const sphere;
  double const h = GetParam();
  double const entry = -std::sqrt(1 - h * h);  // n = 1 there, so that there is no refraction
  RayState<double> const start{{h, 0, entry}, {0, 0, 1}};
  Path const path = walk(sphere, start, pi / 2, 2000);
  // the error with 80 steps is 1.5e-9 (below), so with 2000 steps 4e-15; the rounding of 2000 sums dominates
  EXPECT_NEAR(path.end.position.x, 0, 1e-13);
  EXPECT_NEAR(path.end.position.z, 1, 1e-13);
  EXPECT_NEAR(path.end.optical_direction.x, -h, 1e-13);
  EXPECT_NEAR(path.end.optical_direction.z, std::sqrt(1 - h * h), 1e-13);
  EXPECT_NEAR(path.optical_path + (entry + 1), 1 + pi / 2, 1e-12) << "from the plane z = -1 to the focus";
}
INSTANTIATE_TEST_SUITE_P(Heights, Luneburg, testing::Values(0.0, 0.1, 0.25, 0.5, 0.8, 0.99));

TEST(LuneburgSphereMedium, MidwayPointsAreAsComputed) {
  LuneburgSphere const sphere;
  auto const midway = [&](double h) {
    return walk(sphere, {{h, 0, -std::sqrt(1 - h * h)}, {0, 0, 1}}, pi / 4, 1000).end;
  };
  EXPECT_NEAR(midway(0.25).position.x, 0.176776695296637, 1e-13);
  EXPECT_NEAR(midway(0.25).position.z, 0.0224535843050899, 1e-13);
  EXPECT_NEAR(midway(0.5).position.x, 0.353553390593274, 1e-13);
  EXPECT_NEAR(midway(0.5).position.z, 0.094734345490753, 1e-13);
}

TEST(LuneburgSphereMedium, ErrorsFallAsComputed) {
  LuneburgSphere const sphere;
  double const printed[] = {6.207e-6, 3.798e-7, 2.349e-8, 1.460e-9};
  for (int i = 0; i < 4; ++i) {
    Path const path = walk(sphere, {{0.5, 0, -std::sqrt(0.75)}, {0, 0, 1}}, pi / 2, 10 << i);
    EXPECT_NEAR(length(path.end.position - Vec3d{0, 0, 1}) / printed[i], 1, 1e-3);
  }
}

// The circle through (-1, 0) and (1, 0) that starts at 30 degrees has its centre at -sqrt(3) and the radius 2. Along
// it, dt = ds/n = (8 - 4 sqrt(3) cos(phi)) d phi, phi from -30 to 30 degrees, so that t = 8 pi / 3 - 4 sqrt(3).
TEST(MaxwellFishEye, EveryRayMeetsTheAntipode) {
  FishEye const eye;
  double const t = 8 * pi / 3 - 4 * std::sqrt(3.0);
  RayState<double> const start = launch(eye, 0, -1, 30 * unit::degree);
  Path const coarse = walk(eye, start, t, 100);
  EXPECT_NEAR(length(coarse.end.position - Vec3d{0, 0, 1}) / 5.83e-9, 1, 1e-2);
  Path const fine = walk(eye, start, t, 4000);
  EXPECT_NEAR(fine.end.position.x, 0, 1e-13);
  EXPECT_NEAR(fine.end.position.z, 1, 1e-13);
  EXPECT_NEAR(fine.optical_path, pi, 1e-12);

  RayState<double> const middle = walk(eye, start, t / 2, 2000).end;
  EXPECT_NEAR(middle.position.x, 2 - std::sqrt(3.0), 1e-13);
  EXPECT_NEAR(middle.position.z, 0, 1e-13);
  RayState<double> const quarter = walk(eye, start, t / 4, 2000).end;
  EXPECT_NEAR(length(quarter.position - Vec3d{-std::sqrt(3.0), 0, 0}), 2, 1e-13);
}

TEST(RayEquation, SkewRayKeepsItsAngularMomentum) {
  // in a medium that is symmetric about z, x T_y - y T_x is constant (Bouguer's skew invariant)
  ParabolicRod const rod;
  double const n = 1 + rod.sample({1, 0.5, 0}).refractivity;
  RayState<double> const start{{1, 0.5, 0}, normalized(Vec3d{-0.02, 0.05, 1}) * n};
  auto const skew = [](RayState<double> const& ray) {
    return ray.position.x * ray.optical_direction.y - ray.position.y * ray.optical_direction.x;
  };
  RayState<double> const end = walk(rod, start, 12, 1000).end;
  EXPECT_NEAR(skew(end), skew(start), 1e-12);
}

}  // namespace
}  // namespace gladstone
