#include "render/medium/trace_medium.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"
#include "studies/oracles/oracle_media.h"
#include "tests/support/gridded.h"

namespace gladstone {
namespace {

using oracle::FishEye;
using oracle::ParabolicRod;

constexpr double K = 2.26e-4, rho_0 = 1.225;  // Table 1
constexpr double n_0 = 1 + K * rho_0;

/// Uniform refractive index within a box.
struct GlassBox {
  double n = 1.5;
  Bounds<double> box{{-1, -1, -1}, {1, 1, 1}};

  Bounds<double> bounds() const { return box; }
  IndexSample<double> sample(Vec3d) const { return {n - 1, {}}; }
};

TracingOptions<double> options(double step, Faces faces = Faces::matched, Integrator integrator = Integrator::rk4,
                               double ambient_refractivity = K * rho_0) {
  return {step, ambient_refractivity, integrator, faces};
}

UniformGradient<double> slab(Vec3d gradient, double thickness = 0.01) {
  UniformGradient<double> field;
  field.half_thickness = thickness / 2;
  field.gladstone_dale = K;
  field.ambient_density = rho_0;
  field.gradient = gradient;
  return field;
}

Ray<double> ray(Vec3d position, Vec3d direction) { return {position, normalized(direction)}; }

// --- the BOS slab n = n0 + alpha x, on the axis: x(z) = (n0/alpha)(cosh(alpha z/n0) - 1), a catenary; reference values
// with 40 digits

double slab_displacement(double gradient, Faces faces, double step) {
  Ray<double> const start = ray({0, 0, -0.25}, {0, 0, 1});
  return apparent_ray(start, trace_medium(slab({gradient, 0, 0}), options(step, faces), start)).position.x;
}

TEST(BosSlab, DisplacementIsExactWithRefractingFaces) {
  for (double step : {1e-3, 2.5e-3}) {
    EXPECT_NEAR(slab_displacement(10, Faces::refract, step) / -5.64843623238551e-6, 1, 1e-10);
    EXPECT_NEAR(slab_displacement(1000, Faces::refract, step) / -5.64845578957805e-4, 1, 1e-10);
  }
}

TEST(BosSlab, DisplacementIsExactWithMatchedFaces) {
  for (double step : {1e-3, 2.5e-3}) {
    EXPECT_NEAR(slab_displacement(10, Faces::matched, step) / -5.64843623091498e-6, 1, 1e-10);
    EXPECT_NEAR(slab_displacement(1000, Faces::matched, step) / -5.64844108415171e-4, 1, 1e-10);
  }
}

TEST(BosSlab, RayIsACatenary) {
  Ray<double> const start = ray({0, 0, -0.25}, {0, 0, 1});
  auto const field = slab({10, 0, 0});
  MediumPassage<double> const way = trace_medium(field, options(1e-3, Faces::refract), start);
  EXPECT_NEAR(exit_position(start, way).x / 1.12968724613398e-7, 1, 1e-10);
  Vec3d const out = exit_direction(start, way);
  EXPECT_NEAR(out.x / out.z / 2.25937449294075e-5, 1, 1e-10);
  // sin(theta) = sinh(alpha L / n0) with refracting faces
  EXPECT_NEAR(out.x / std::sinh(K * 10 * 0.01 / n_0), 1, 1e-10);
}

// The relative deviation from Eq. 9 is eps^2 [2/3 + (7/24) L/Z_D] with refracting faces and eps^2 [1/6 + (1/24) L/Z_D]
// with matched ones; at 1000 kg/m^4, the next order, eps^4, is 3e-11.
TEST(BosSlab, DeparturesFromEquationNineAreOfSecondOrder) {
  double const eps = K * 1000 * 0.01 / n_0, eq9 = -0.25 * eps, ratio = 0.01 / 0.25;
  EXPECT_NEAR(slab_displacement(1000, Faces::refract, 1e-3) / eq9 - 1, eps * eps * (2.0 / 3 + 7.0 / 24 * ratio), 2e-10);
  EXPECT_NEAR(slab_displacement(1000, Faces::matched, 1e-3) / eq9 - 1, eps * eps * (1.0 / 6 + 1.0 / 24 * ratio), 2e-10);
}

// --- without a gradient nothing changes

TEST(UniformDensity, DisplacesNothingToTheLastBit) {
  auto const check = [](auto const& medium) {
    for (Vec3d direction : {Vec3d{0, 0, 1}, Vec3d{0.01, -0.02, 1}, Vec3d{-0.3, 0.2, 1}}) {
      for (Integrator integrator : {Integrator::rk4, Integrator::euler, Integrator::straight}) {
        Ray<double> const start = ray({0.0013, -0.0007, -0.25}, direction);
        MediumPassage<double> const way = trace_medium(medium, options(7e-4, Faces::matched, integrator), start);
        Ray<double> const seen = apparent_ray(start, way);
        EXPECT_EQ(seen.position, start.position);
        EXPECT_EQ(seen.direction, start.direction);
      }
    }
  };
  check(slab({0, 0, 0}));
  auto dense = slab({0, 0, 0});
  dense.ambient_density = 7;  // with matched faces, for any density
  check(dense);
  auto const constant = [](Vec3d) { return 2.7e-4; };
  auto const plane = test::sampled<double>(test::open_grid(9, 9, 1, {0.1, 0.1, 0.1}, {-0.4, -0.4, 0}), constant);
  check(plane.view<double, CubicBspline, 2>(-0.005, 0.005));
  auto const volume = test::sampled<float>(test::open_grid(9, 9, 9, {0.1, 0.1, 0.001}, {-0.4, -0.4, -0.004}), constant);
  check(volume.view<double, CubicBspline, 3>(0, 0));
  check(volume.view<double, Linear, 3>(0, 0));
}

TEST(UniformDensity, RefractingFacesOfTheAmbientIndexDisplaceNothing) {
  Ray<double> const start = ray({0.001, 0, -0.25}, {0.02, -0.01, 1});
  Ray<double> const seen = apparent_ray(start, trace_medium(slab({0, 0, 0}), options(1e-3, Faces::refract), start));
  EXPECT_NEAR(seen.position.x, start.position.x, 1e-16);  // one rounding of |T|^2 times the lever of 0.25 m
  EXPECT_NEAR(seen.direction.x, start.direction.x, 1e-16);
}

TEST(UniformDensity, AnotherIndexBehindRefractingFacesIsAPlaneParallelPlate) {
  // Snell: sin i = n sin r. The apparent source is shifted by L (tan i - tan r) along x, which is L (tan i - tan r) cos
  // i perpendicularly to the ray.
  GlassBox const plate{1.5168, {{-10, -10, 0}, {10, 10, 10e-3}}};
  for (auto [degrees, lateral] :
       {std::pair{10.0, 0.601580184310577e-3}, {30.0, 1.97621122205116e-3}, {60.0, 5.18297750549795e-3}}) {
    double const i = degrees * unit::degree;
    Ray<double> const start = ray({0, 0, -0.1}, {std::sin(i), 0, std::cos(i)});
    MediumPassage<double> const way = trace_medium(plate, options(1e-3, Faces::refract, Integrator::rk4, 0), start);
    Ray<double> const seen = apparent_ray(start, way);
    EXPECT_NEAR(-(seen.position.x - start.position.x) * std::cos(i), lateral, 1e-15);
    EXPECT_NEAR(seen.direction.x, start.direction.x, 1e-15);
    // optical path: outside at n = 1, inside L n / cos r
    double const inside = 0.01 * 1.5168 / std::sqrt(1 - std::pow(std::sin(i) / 1.5168, 2));
    EXPECT_NEAR(way.optical_path, 0.1 / std::cos(i) + inside, 1e-15);
  }
}

TEST(UniformDensity, GradientAlongTheAxisMovesNoAxialRay) {
  Ray<double> const start = ray({0, 0, -0.25}, {0, 0, 1});
  for (Faces faces : {Faces::matched, Faces::refract}) {
    Ray<double> const seen = apparent_ray(start, trace_medium(slab({0, 0, 1000}), options(1e-3, faces), start));
    EXPECT_EQ(seen.position.x, 0);
    EXPECT_EQ(seen.position.y, 0);
    EXPECT_EQ(seen.direction.x, 0);
  }
}

// --- along curved rays

TEST(TracedRod, ExitIsTheAnalyticOneOnTheFace) {
  ParabolicRod const rod;
  Ray<double> const start = ray({0.5, 0, -3}, {0, 0, 1});
  // straight path of 3 mm to the face, then the rod; matched faces do not change the direction
  MediumPassage<double> const way = trace_medium(rod, options(0.013), start);
  Vec3d const out = exit_position(start, way);
  double const n = 1 + rod.sample({0.5, 0, 0}).refractivity, w = rod.n0 * rod.g;
  EXPECT_NEAR(out.x, 0.5 * std::cos(w * 20 / n), 1e-11);
  EXPECT_NEAR(out.z, 20, 1e-14);
  Vec3d const d = exit_direction(start, way);
  EXPECT_NEAR(d.x / d.z, -0.5 * w / n * std::sin(w * 20 / n), 1e-11);
  EXPECT_NEAR(length(d), 1, 1e-15);
  Vec3d const T = way.straight + way.turn;
  EXPECT_NEAR(length(T), std::sqrt(rod.squared_index(out)), 1e-11) << "|T| = n";
  // integral of n0^2 (1 - g^2 r^2) over t
  double const t = 20 / n, c = 0.5 * rod.g;
  double const inside = rod.n0 * rod.n0 * (t - c * c * (t / 2 + std::sin(2 * w * t) / (4 * w)));
  EXPECT_NEAR(way.optical_path, 3 * n_0 + inside, 1e-8);
}

TEST(TracedRod, PrintedObliqueRayIsMet) {
  ParabolicRod const rod;
  Ray<double> const start = ray({0.5, 0, 0}, {std::sin(5 * unit::degree), 0, std::cos(5 * unit::degree)});
  MediumPassage<double> const way = trace_medium(rod, options(0.01), start);
  EXPECT_NEAR(exit_position(start, way).x, 0.575115661124331, 1e-11);
  Vec3d const d = exit_direction(start, way);
  EXPECT_NEAR(d.x / d.z, -0.082695012375395, 1e-11);
}

// Steps that do not divide the thickness: the first and the last one are partial, and the exit face is reached without
// loss of accuracy.
TEST(TracedRod, AnyStepKeepsOrderFour) {
  ParabolicRod const rod;
  auto const error = [&](double step) {
    Ray<double> const start = ray({1, 0, 0}, {0, 0, 1});
    MediumPassage<double> const way = trace_medium(rod, options(step), start);
    Vec3d const out = exit_position(start, way);
    EXPECT_NEAR(out.z, 20, 1e-14) << step;
    return std::abs(out.x - -0.425287303350492);
  };
  // In the rod x'' = -w^2 x, for which the method (Sharma, Kumar & Ghatak 1982) with N = 20 / h whole steps of h [mm]
  // has the error 5.946e-7 h^4 at N = 20 and 5.875e-7 h^4 at N = 40, computed by its recursion.
  for (double step : {0.31, 0.47, 0.7, 0.83, 1.3, 1.9}) {
    double const whole = 5.946e-7 * std::pow(step, 4);
    EXPECT_LT(error(step), 1.2 * whole) << step;
    EXPECT_GT(error(step), 0.3 * whole) << step;
  }
}

TEST(TracedRod, EulerIsOfOrderOne) {
  ParabolicRod const rod;
  auto const error = [&](double step) {
    Ray<double> const start = ray({1, 0, 0}, {0, 0, 1});
    MediumPassage<double> const way = trace_medium(rod, options(step, Faces::matched, Integrator::euler), start);
    EXPECT_NEAR(exit_position(start, way).z, 20, 1e-14);
    return std::abs(exit_position(start, way).x - -0.425287303350492);
  };
  EXPECT_NEAR(error(0.01) / error(0.005), 2, 0.05);
}

// --- the straight integrator: each slice has its own lever, dz along the undeflected ray

TEST(StraightIntegrator, GivesTheLeveredIntegralOfASinusoid) {
  Sinusoid<double> field;
  field.half_thickness = 0.005;
  field.gladstone_dale = K;
  field.ambient_density = rho_0;
  double const k = 2 * pi / 0.004;
  field.amplitude = 10 / k;
  field.wavevector = {k, 0};
  field.phase = 0.4;
  for (double slope : {0.0, 0.01, 0.05}) {
    double const x0 = 3e-4, s1 = 0.245, s2 = 0.255;
    Ray<double> const start = ray({x0, 0, -0.25}, {slope, 0, 1});
    MediumPassage<double> const way = trace_medium(field, options(2.5e-4, Faces::matched, Integrator::straight), start);
    // integral of s cos(k (x0 + m s) + phase) ds
    auto const primitive = [&](double s) {
      double const phase = k * (x0 + slope * s) + field.phase, q = k * slope;
      return q == 0 ? std::cos(phase) * s * s / 2 : s * std::sin(phase) / q + std::cos(phase) / (q * q);
    };
    double const lever_weighted = K * 10 * (primitive(s2) - primitive(s1));
    // T_z is constant, so tan(theta') - tan(theta) = (1 + m^2) / n0 times the integral, up to relative terms of K
    // amplitude (1.4e-6) and of Simpson's rule, (k m h)^4/2880.
    EXPECT_NEAR(apparent_ray(start, way).position.x - x0, -(1 + slope * slope) / n_0 * lever_weighted,
                1e-5 * std::abs(K * 10 * 0.0025));
  }
}

// --- reversal: the ray equation is symmetric under reversal of the direction

template <class Medium>
void expect_reversible(Medium const& medium, TracingOptions<double> const& how, Ray<double> const& start,
                       double beyond) {
  MediumPassage<double> const out = trace_medium(medium, how, start);
  ASSERT_TRUE(out.crossed);
  ASSERT_EQ(out.status, RayStatus::alive);
  Vec3d const direction = exit_direction(start, out);
  Ray<double> const back{exit_position(start, out) + direction * beyond, -direction};
  MediumPassage<double> const home = trace_medium(medium, how, back);
  ASSERT_EQ(home.status, RayStatus::alive);
  Vec3d const d = exit_direction(back, home);
  EXPECT_LT(length(d + start.direction), 1e-10);
  // point at which the reversed ray passes the start
  Vec3d const p = exit_position(back, home);
  Vec3d const missed = p + d * dot(start.position - p, d) - start.position;
  EXPECT_LT(length(missed), 1e-10 * std::max(1.0, length(start.position)));
}

TEST(TimeReversal, HoldsInASinusoidWithBothFaces) {
  Sinusoid<double> field;
  field.half_thickness = 0.005;
  field.gladstone_dale = K;
  field.ambient_density = rho_0;
  field.amplitude = 0.05;
  field.wavevector = Vec2d{1, 0.5} * (2 * pi / 0.004);
  for (Faces faces : {Faces::matched, Faces::refract}) {
    for (Vec3d direction : {Vec3d{0, 0, 1}, Vec3d{0.02, -0.03, 1}, Vec3d{0.5, 0.2, 1}}) {
      expect_reversible(field, options(3e-4, faces), ray({1e-3, 2e-3, -0.25}, direction), 0.3);
    }
  }
}

TEST(TimeReversal, HoldsInAGriddedVolume) {
  // a smooth three-dimensional pattern of blobs, amplitude 1e-4, structures of a dozen cells
  auto const grid = test::open_grid(33, 33, 33, {5e-4, 5e-4, 5e-4}, {-8e-3, -8e-3, -8e-3});
  auto const volume = test::sampled<float>(grid, [](Vec3d p) {
    return 2.7e-4 + 1e-4 * std::sin(900 * p.x + 0.3) * std::cos(700 * p.y) * std::sin(800 * p.z + 1);
  });
  auto const medium = volume.view<double, CubicBspline, 3>(0, 0);
  for (Faces faces : {Faces::matched, Faces::refract}) {
    expect_reversible(medium, options(1e-4, faces), ray({1e-3, 2e-3, -0.25}, {0, 0, 1}), 0.3);
    expect_reversible(medium, options(1e-4, faces), ray({-1e-2, 2e-3, -0.25}, {0.04, -0.01, 1}), 0.3);
    // in through a side face, out through the rear face
    expect_reversible(medium, options(1e-4, faces), ray({-2e-2, 1e-3, -1e-2}, {1, 0.1, 0.8}), 0.05);
  }
}

TEST(TimeReversal, HoldsInTheRod) {
  expect_reversible(ParabolicRod{}, options(0.01), ray({0.7, -0.4, -2}, {0.03, 0.05, 1}), 3);
}

// --- faces, edges and rays that do not leave the medium

TEST(TraceMedium, RayThatMissesComesBackAsItWas) {
  GlassBox const box;
  for (Ray<double> const& start :
       {ray({2, 0, -5}, {0, 0, 1}), ray({0, 0, 5}, {0.1, 0, 1}), ray({0, -3, -5}, {0.3, 0.01, 1})}) {
    MediumPassage<double> const way = trace_medium(box, options(0.1, Faces::refract), start);
    EXPECT_FALSE(way.crossed);
    EXPECT_EQ(way.status, RayStatus::alive);
    EXPECT_EQ(way.optical_path, 0);
    EXPECT_EQ(exit_position(start, way), start.position);
    EXPECT_EQ(exit_direction(start, way), start.direction);
    EXPECT_EQ(apparent_ray(start, way).position, start.position);
    EXPECT_EQ(apparent_ray(start, way).direction, start.direction);
  }
}

TEST(TraceMedium, NoMediumIsNeverCrossed) {
  Ray<double> const start = ray({0, 0, -0.25}, {0, 0, 1});
  EXPECT_FALSE(trace_medium(NoMedium<double>{}, options(1e-3), start).crossed);
}

// In through a side face and out through the rear one: Snell's law conserves the components of n d along each face.
TEST(TraceMedium, RayEntersThroughASide) {
  GlassBox const box{1.1, {{-1, -1, -1}, {1, 1, 1}}};
  Ray<double> const start = ray({-1.5, 0.1, 0}, {0.5, 0.1, 0.8});
  MediumPassage<double> const way = trace_medium(box, options(0.1, Faces::refract, Integrator::rk4, 0), start);
  ASSERT_EQ(way.status, RayStatus::alive);
  Vec3d inside = start.direction;
  inside.x = std::sqrt(1.1 * 1.1 - inside.y * inside.y - inside.z * inside.z);
  Vec3d const entry = start.position + start.direction * (0.5 / start.direction.x);
  Vec3d const leave = entry + inside * ((1 - entry.z) / inside.z);
  EXPECT_LT(length(exit_position(start, way) - leave), 1e-14);
  EXPECT_EQ(exit_position(start, way).z, 1);
  Vec3d out = inside;
  out.z = std::sqrt(1 - inside.x * inside.x - inside.y * inside.y);
  EXPECT_LT(length(exit_direction(start, way) - out), 1e-14);
  double const glass = 1.1 * length(leave - entry);
  EXPECT_NEAR(way.optical_path, length(entry - start.position) + glass, 1e-14);
}

// n^2 > 2: light that enters a cube through one face cannot leave it through an adjacent one.
TEST(TraceMedium, GlassCubeReflectsTotally) {
  GlassBox const box{1.5, {{-1, -1, -1}, {1, 1, 1}}};
  Ray<double> const start = ray({-1.5, 0, -0.5}, {0.5, 0, 0.6});
  EXPECT_EQ(trace_medium(box, options(0.1, Faces::refract, Integrator::rk4, 0), start).status,
            RayStatus::total_internal_reflection);
  EXPECT_EQ(trace_medium(box, options(0.1, Faces::matched, Integrator::rk4, 0), start).status, RayStatus::alive);
}

TEST(TraceMedium, ThinnerMediumReflectsAtItsEntry) {
  GlassBox const bubble{1.0, {{-1, -1, -1}, {1, 1, 1}}};
  Ray<double> const start = ray({-1, 0, -2}, {1, 0, 0.9});  // 48 degrees; the critical angle for 1.5 is 41.8 degrees
  EXPECT_EQ(trace_medium(bubble, options(0.1, Faces::refract, Integrator::rk4, 0.5), start).status,
            RayStatus::total_internal_reflection);
}

TEST(TraceMedium, RayThatStartsInsideGoesOnFromThere) {
  ParabolicRod const rod;
  // half of a rod, from its middle: r = cos(w z / p_z)
  Ray<double> const start = ray({1, 0, 10}, {0, 0, 1});
  MediumPassage<double> const way = trace_medium(rod, options(0.01), start);
  double const n = 1 + rod.sample(start.position).refractivity, w = rod.n0 * rod.g;
  EXPECT_EQ(way.entry, 0);
  EXPECT_NEAR(exit_position(start, way).x, std::cos(w * 10 / n), 1e-11);
  EXPECT_NEAR(exit_position(start, way).z, 20, 1e-14);
}

TEST(TraceMedium, RayParallelToAFaceIsCarriedToTheOneAcross) {
  GlassBox const box{1.1, {{-1, -1, -1}, {1, 1, 1}}};
  for (double x : {-1.0, 0.25, 1.0}) {  // positions in the faces themselves are included
    Ray<double> const start = ray({x, 0, -2}, {0, 0, 1});
    MediumPassage<double> const way = trace_medium(box, options(0.3), start);
    EXPECT_TRUE(way.crossed);
    EXPECT_EQ(exit_position(start, way), (Vec3d{x, 0, 1}));
    EXPECT_NEAR(way.optical_path, n_0 + 2.2, 1e-15);
  }
}

TEST(TraceMedium, LandsOnTheRearFaceExactly) {
  for (double thickness : {0.01, 0.0123, 0.1}) {
    for (double step : {1e-3, 7.7e-4, 0.02}) {
      for (Vec3d direction : {Vec3d{0, 0, 1}, Vec3d{0.02, 0.01, 1}, Vec3d{-0.4, 0.3, 1}}) {
        for (double gradient : {10.0, 1e4}) {
          Ray<double> const start = ray({0, 0, -0.25}, direction);
          auto const way = trace_medium(slab({gradient, 0, gradient}, thickness), options(step), start);
          EXPECT_NEAR(exit_position(start, way).z, thickness / 2, 1e-15) << thickness << " " << step << " " << gradient;
        }
      }
    }
  }
}

// A strong gradient reverses a grazing ray: it leaves through the face by which it entered, along a parabola.
TEST(TraceMedium, RayMayTurnBack) {
  oracle::LinearSquaredIndex medium;
  medium.box = {{-unbounded, -unbounded, -unbounded}, {10, unbounded, unbounded}};
  medium.box.low.x = -20;
  medium.a = 0.02;
  // The ray starts at x = 1 up the slope at 30 degrees, with p_x = -0.5 n, turns at x = 1 - p_x^2 / (2 a), above the
  // lower bound, returns to x = 1 with +p_x and leaves at x = 10.
  Ray<double> const start = ray({1, 0, 0}, {-0.5, 0, std::sqrt(0.75)});
  double const n = std::sqrt(1.04), px = -0.5 * n, pz = std::sqrt(0.75) * n;
  double const t = (-px + std::sqrt(px * px + 2 * 0.02 * 9)) / 0.02;
  MediumPassage<double> const way = trace_medium(medium, options(0.5), start);
  ASSERT_EQ(way.status, RayStatus::alive);
  EXPECT_NEAR(exit_position(start, way).x, 10, 1e-12);
  EXPECT_NEAR(exit_position(start, way).z, pz * t, 1e-10);
}

// A ray on a circle about the centre of the fish-eye lens never leaves it.
TEST(TraceMedium, TrappedRayIsLost) {
  FishEye const eye;
  Ray<double> const start = ray({1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(trace_medium(eye, options(0.05), start).status, RayStatus::lost_in_medium);
}

// Far out in an infinite gradient, the index decreases to zero. Rays there are not traced.
TEST(TraceMedium, RayAtInvalidIndexIsLost) {
  for (double const x : {-1.0, -1e3}) {
    auto const way = trace_medium(slab({8e3, 0, 0}), options(1e-3), ray({x, 0, -0.1}, {0, 0, 1}));
    EXPECT_EQ(way.status, RayStatus::lost_in_medium) << x;  // n = 1 + 2.26e-4 8e3 x < 0
  }
}

// A slab is infinite along x and y: a ray that travels within it must be abandoned, not followed for ever.
TEST(TraceMedium, RayWithinAnEndlessSlabEnds) {
  Ray<double> const start = ray({-1, 0, 0}, {1, 0, 0});
  EXPECT_EQ(trace_medium(slab({0, 0, 0}), options(1e-3), start).status, RayStatus::lost_in_medium);
  // A gradient across the slab deflects the ray out of it: z = alpha x^2 / (2 n0) reaches 5 mm after 2.1 m; with n = n0
  // + alpha z, the path is a catenary.
  MediumPassage<double> const way = trace_medium(slab({0, 0, 10}), options(1e-3), start);
  ASSERT_EQ(way.status, RayStatus::alive);
  double const a = n_0 / (K * 10);
  EXPECT_NEAR(exit_position(start, way).x, -1 + a * std::acosh(1 + 0.005 / a), 1e-9);
  EXPECT_NEAR(exit_position(start, way).z, 0.005, 1e-15);
}

// Rays from many positions, including grazing ones, through a strongly inhomogeneous glass (n from 1.1 to 1.5 over four
// cells): every ray that leaves it does so on a face, with a unit direction.
TEST(TraceMedium, EveryRayEndsOnAFace) {
  auto grid = test::open_grid(12, 10, 11, {1e-3, 1.1e-3, 0.9e-3}, {-5e-3, -5e-3, -5e-3});
  for (bool periodic : {false, true}) {
    grid.periodic = {periodic, periodic, false};
    auto const volume = test::sampled<float>(grid, [](Vec3d p) {
      return 0.3 + 0.2 * std::sin(900 * p.x + 0.3) * std::cos(700 * p.y) * std::sin(800 * p.z + 1);
    });
    auto const medium = volume.view<double, CubicBspline, 3>(0, 0);
    Bounds<double> const box = medium.bounds();
    int alive = 0;
    for (int i = 0; i < 20000; ++i) {
      // low-discrepancy sequence of positions and directions
      auto const u = [i](double irrational) { return 2 * std::fmod((i + 1) * irrational, 1.0) - 1; };
      Vec3d const direction{u(0.754877666), u(0.569840291), 0.05 + std::abs(u(0.430159709))};
      Ray<double> const start =
          ray({8e-3 * u(0.618033989), 8e-3 * u(0.414213562), i % 5 == 0 ? 2e-3 : -0.02}, direction);
      auto how = options(i % 2 == 0 ? 7e-4 : 1e-4, i % 4 < 2 ? Faces::matched : Faces::refract);
      MediumPassage<double> const way = trace_medium(medium, how, start);
      if (!way.crossed || way.status != RayStatus::alive) continue;
      ++alive;
      Vec3d const end = exit_position(start, way);
      double off = 1;
      for (int axis = 0; axis < 3; ++axis) {
        off = std::min({off, std::abs(end[axis] - box.low[axis]), std::abs(end[axis] - box.high[axis])});
      }
      EXPECT_LT(off, 1e-15) << i;
      EXPECT_NEAR(length(exit_direction(start, way)), 1, 1e-14) << i;
    }
    EXPECT_GT(alive, 1000) << "of 20000 rays; some miss the medium, some are totally reflected";
  }
}

// By rounding, the computed entry point can be in front of the face. If the steps nearly divide the chord, this is more
// than the length of the first step. The ray must still count as inside and cross the whole slab.
TEST(TraceMedium, RaysDoNotLeaveByTheFaceTheyEnter) {
  for (int i = 0; i < 2000; ++i) {
    double const slope = 0.02 * i / 2000;
    Ray<double> const start = ray({0, 0, -0.25}, {slope, 0.3 * slope, 1});
    MediumPassage<double> const way = trace_medium(slab({10, 0, 0}), options(2.5e-3), start);
    EXPECT_NEAR(exit_position(start, way).z, 0.005, 1e-15) << i;
  }
}

}  // namespace
}  // namespace gladstone
