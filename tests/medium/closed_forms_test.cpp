#include "render/medium/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/medium/trace_medium.h"
#include "tests/support/gridded.h"

namespace gladstone {
namespace {

constexpr double K = 2.26e-4, rho_0 = 1.225, n_0 = 1 + K * rho_0;

/// Returns the medium of a setup with this field.
template <class Field>
Field built(Field const& field, double thickness = 0.01) {
  MediumSetup setup;
  setup.thickness = thickness;
  setup.field = field;
  return std::get<Field>(build_medium(setup).view);
}

TracingOptions<double> options(double step, Integrator integrator = Integrator::rk4) {
  return {step, K * rho_0, integrator, Faces::matched};
}

/// Returns the slope dx/dz with which a ray that starts along the axis at x leaves the medium.
template <class Field>
double deflection(Field const& field, double x, double step, double from = -0.25) {
  Ray<double> const start{{x, 0, from}, {0, 0, 1}};
  Vec3d const d = exit_direction(start, trace_medium(field, options(step), start));
  return d.x / d.z;
}

template <class Field>
void expect_consistent_gradient(Field const& field, double length_scale) {
  double const h = 1e-4 * length_scale;
  for (Vec3d p : {Vec3d{0.3, -0.2, 0.1}, Vec3d{-0.7, 0.4, -0.5}, Vec3d{0, 1.1, 0.2}}) {
    Vec3d const at = p * length_scale;
    Vec3d const gradient = field.sample(at).gradient;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d step{};
      step[axis] = h;
      double const difference = (field.sample(at + step).refractivity - field.sample(at - step).refractivity) / (2 * h);
      // truncation error h^2/6 times the third derivative, about 1e-7 of the largest gradient, and rounding of n - 1
      // over h
      EXPECT_NEAR(gradient[axis], difference, 1e-6 * field.gladstone_dale / length_scale) << "axis " << axis;
    }
  }
}

TEST(ClosedForms, GradientsAreDerivatives) {
  expect_consistent_gradient(built(UniformGradient<double>{{}, {10, -20, 5}}), 1e-3);
  expect_consistent_gradient(built(Sinusoid<double>::wave(0.3, 4e-3, {0.6, 0.8}, 0.5)), 1e-3);
  expect_consistent_gradient(built(GaussianPlume<double>{{{}, -0.6, 1e-3}}), 1e-3);
  expect_consistent_gradient(built(GaussianBlob<double>{{{}, -0.6, 1e-3}}), 1e-3);
  expect_consistent_gradient(built(NormalShock<double>::front(2, 0.5, 3e-3, 0.4)), 1e-3);
}

TEST(ClosedForms, ValuesAreThoseOfTheFormulae) {
  auto const gradient = built(UniformGradient<double>{{}, {10, -20, 5}});
  EXPECT_NEAR(gradient.sample({1e-3, 2e-3, 3e-3}).refractivity, K * (rho_0 - 0.015), 1e-18);
  auto const wave = built(Sinusoid<double>::wave(0.3, 4e-3, {0, 1}));
  EXPECT_NEAR(wave.sample({7, 1e-3, 9}).refractivity, K * (rho_0 + 0.3), 1e-18);
  auto const plume = built(GaussianPlume<double>{{{}, -0.6, 1e-3}});
  EXPECT_NEAR(plume.sample({6e-4, 5, 8e-4}).refractivity, K * (rho_0 - 0.6 * std::exp(-1)), 1e-18);
  auto const blob = built(GaussianBlob<double>{{{}, -0.6, 1e-3}});
  EXPECT_NEAR(blob.sample({2e-3, 1e-3, 2e-3}).refractivity, K * (rho_0 - 0.6 * std::exp(-9)), 1e-18);
}

// Abel pair of the Gaussian: eps(x) = -2 sqrt(pi) (dn/n0)(x/a) exp(-x^2/a^2), largest at x = a/sqrt(2), where it is
// sqrt(2 pi / e) dn/n0 = 1.520347 dn/n0. The deflection moves the ray by eps a, so with dn = 2.3e-7 the error is below
// 1e-6.
TEST(GaussianPlumeField, LargestDeflectionIsTheAbelIntegral) {
  double const a = 5e-3;
  // the slab ends where the field has decayed to exp(-36)
  auto const plume = built(GaussianPlume<double>{{{}, 1e-3, a}}, 12 * a);
  double const dn = K * 1e-3;
  auto const scaled = [&](double x) { return -deflection(plume, x, a / 20) * n_0 / dn; };
  EXPECT_NEAR(scaled(a / std::sqrt(2.0)), 1.520347, 2e-6);
  EXPECT_NEAR(scaled(a / std::sqrt(2.0)), std::sqrt(2 * pi / std::exp(1)), 1e-6);
  EXPECT_LT(scaled(0.98 * a / std::sqrt(2.0)), scaled(a / std::sqrt(2.0)));
  EXPECT_LT(scaled(1.02 * a / std::sqrt(2.0)), scaled(a / std::sqrt(2.0)));
  for (double x : {-0.3, 0.4, 1.5}) EXPECT_NEAR(scaled(x * a), 2 * std::sqrt(pi) * x * std::exp(-x * x), 1e-6);
}

TEST(GaussianBlobField, DeflectionIsThePlumesTimesItsExtentInY) {
  double const a = 5e-3;
  auto const blob = built(GaussianBlob<double>{{{}, 1e-3, a}}, 12 * a);
  Ray<double> const start{{0.4 * a, 0.3 * a, -0.25}, {0, 0, 1}};
  Vec3d const d = exit_direction(start, trace_medium(blob, options(a / 20), start));
  double const scale = -2 * std::sqrt(pi) * K * 1e-3 / n_0 * std::exp(-0.25);
  EXPECT_NEAR(d.x / d.z / scale, 0.4, 1e-6);
  EXPECT_NEAR(d.y / d.z / scale, 0.3, 1e-6);
}

// --- shocks: NACA Report 1135 (1953), gamma = 1.4

TEST(NormalShockField, DensityRatiosAreRankineHugoniots) {
  EXPECT_NEAR(shock_density_ratio(1.0, 1.4), 1, 1e-15);
  EXPECT_NEAR(shock_density_ratio(1.5, 1.4), 1.862068966, 1e-9);
  EXPECT_NEAR(shock_density_ratio(2.0, 1.4), 2.666666667, 1e-9);
  EXPECT_NEAR(shock_density_ratio(3.0, 1.4), 3.857142857, 1e-9);
  EXPECT_NEAR(shock_density_ratio(1e6, 1.4), 6, 1e-9);  // the strong limit (gamma + 1)/(gamma - 1)
}

NormalShock<double> mach_2(double thickness, double tilt, double position = 0) {
  return built(NormalShock<double>::front(2, 0.5, thickness, tilt, position), 0.02);
}

TEST(NormalShockField, RunsFromUpstreamToDownstreamOverItsThickness) {
  auto const shock = mach_2(1e-3, 0, 2e-3);
  EXPECT_NEAR(shock.sample({-0.1, 0, 0}).refractivity, K * 0.5, 1e-18);
  EXPECT_NEAR(shock.sample({0.1, 0, 0}).refractivity, K * 0.5 * 8 / 3, 1e-18);
  EXPECT_NEAR(shock.sample({2e-3, 0, 0}).refractivity, K * 0.5 * 11 / 6, 1e-18);
  EXPECT_NEAR(shock.sample({2e-3, 0, 0}).gradient.x, K * 0.5 * (5.0 / 3) / 1e-3, 1e-13) << "jump / thickness";
}

/// Snell's law at a plane whose normal makes the angle `incidence` with the ray: the tangential component of n d is
/// conserved.
double snell_slope(double n1, double n2, double incidence) {
  return std::tan(incidence - std::asin(n1 / n2 * std::sin(incidence)));
}

// A ray that crosses the whole jump is refracted by Snell's law at the tilted plane, whatever the width of the jump; a
// tilt of 30 degrees is an angle of incidence of 60. For a small width, the tails, tanh(4 d / w), decay within the
// slab, so that the error decreases with the width.
TEST(NormalShockField, TiltedJumpConvergesToSnell) {
  double const tilt = 30 * unit::degree, incidence = pi / 2 - tilt;
  double const n1 = 1 + K * 0.5, n2 = 1 + K * 0.5 * 8 / 3;
  double const snell = snell_slope(n1, n2, incidence);
  EXPECT_NEAR(snell / ((n2 - n1) * std::tan(incidence)), 1, 1e-3) << "dn tan(phi), to first order in dn";
  double before = 1;
  for (double width : {8e-3, 4e-3, 2e-3, 1e-3}) {
    auto const shock = mach_2(width, tilt);
    double const error = std::abs(deflection(shock, 0, width / 40) / snell - 1);
    EXPECT_LT(error, 0.5 * before) << width;
    before = error;
  }
  EXPECT_LT(before, 1e-7) << "tails of 2 exp(-4 * 5 mm / 1 mm) = 4e-9, and the error of the scheme";
}

// The jump is sampled on a grid of 0.1 mm, with nodal values in float and a spline between them.
TEST(NormalShockField, GriddedJumpRefractsLikeSnell) {
  double const tilt = 30 * unit::degree, incidence = pi / 2 - tilt, cell = 1e-4;
  double const n1 = 1 + K * 0.5, n2 = 1 + K * 0.5 * 8 / 3;
  double const snell = snell_slope(n1, n2, incidence);
  for (double width : {1.6e-3, 0.8e-3, 0.4e-3}) {
    auto const shock = mach_2(width, tilt);
    auto const grid = test::open_grid(41, 4, 101, {cell, cell, cell}, {-20 * cell, -cell, -50 * cell});
    auto const volume = test::sampled<float>(grid, [&](Vec3d p) { return shock.sample(p).refractivity; });
    double const traced = deflection(volume.view<double, CubicBspline, 3>(0, 0), 0, cell / 4);
    // The tails extend over +-5 mm along z: 2 exp(-4 * 2.5 / 1.6) = 4e-3 for the widest jump. The grid resolves the
    // narrowest jump by 4 cells.
    EXPECT_NEAR(traced / snell, 1, 2.2 * std::exp(-4 * 2.5e-3 / width) + 1e-3) << width;
  }
}

}  // namespace
}  // namespace gladstone
