#include "render/medium/refractive_index_volume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"
#include "render/medium/trace_medium.h"
#include "tests/support/gridded.h"

namespace gladstone {
namespace {

using test::open_grid;
using test::sampled;

/// A field that is cubic in each variable; its values at small integers are exact in float.
double cubic(double x) { return x * x * x - 2 * x * x - 3 * x + 1; }
double cubic_slope(double x) { return 3 * x * x - 4 * x - 3; }

/// A field without symmetry that is smooth over several cells of a unit grid.
double rough(Vec3d p) {
  return 1e-4 * (std::sin(0.7 * p.x + 0.1) * std::cos(0.5 * p.y - 0.4) + 0.3 * std::sin(0.9 * p.z + p.x));
}

// --- the spline reproduces all products of cubics, values and gradients, including the edges

TEST(SplinePlane, ReproducesBicubicPolynomialsToTheEdge) {
  auto const volume = sampled<double>(open_grid(7, 6, 1), [](Vec3d p) { return cubic(p.x) * cubic(p.y); });
  auto const plane = volume.view<double, CubicBspline, 2>(-1, 1);
  double const scale = cubic(6) * cubic(5);  // 127 * 61
  for (double x = 0; x <= 6; x += 0.25) {
    for (double y = 0; y <= 5; y += 0.25) {
      auto const at = plane.sample({x, y, 0.3});
      EXPECT_NEAR(at.refractivity, cubic(x) * cubic(y), 1e-12 * scale);
      EXPECT_NEAR(at.gradient.x, cubic_slope(x) * cubic(y), 1e-12 * scale);
      EXPECT_NEAR(at.gradient.y, cubic(x) * cubic_slope(y), 1e-12 * scale);
      EXPECT_EQ(at.gradient.z, 0);
    }
  }
}

template <class Stored>
void expect_tricubic(double relative) {
  auto const f = [](Vec3d p) { return cubic(p.x) * cubic(p.y) * cubic(p.z); };
  auto const volume = sampled<Stored>(open_grid(5, 6, 4), f);
  auto const view = volume.template view<double, CubicBspline, 3>(0, 0);
  double const tolerance = relative * std::abs(cubic(4) * cubic(5) * cubic(3));
  for (double x = 0; x <= 4; x += 0.5) {
    for (double y = 0; y <= 5; y += 0.5) {
      for (double z = 0; z <= 3; z += 0.5) {
        auto const at = view.sample({x, y, z});
        EXPECT_NEAR(at.refractivity, f({x, y, z}), tolerance);
        EXPECT_NEAR(at.gradient.x, cubic_slope(x) * cubic(y) * cubic(z), tolerance);
        EXPECT_NEAR(at.gradient.y, cubic(x) * cubic_slope(y) * cubic(z), tolerance);
        EXPECT_NEAR(at.gradient.z, cubic(x) * cubic(y) * cubic_slope(z), tolerance);
      }
    }
  }
}

// Tolerance: three filter passes over floats, each of which amplifies rounding errors up to 6-fold at the not-a-knot
// ends: some tens of 6e-8 times the largest value.
TEST(SplineVolume, ReproducesTricubicPolynomialsToFloat) { expect_tricubic<float>(5e-6); }
TEST(SplineVolume, ReproducesTricubicPolynomialsInDouble) { expect_tricubic<double>(1e-13); }

// N nodes determine a polynomial of degree at most N - 1.
TEST(SplineVolume, SmallGridsReproduceWhatTheyCan) {
  for (int nodes : {2, 3, 4, 5}) {
    int const degree = std::min(nodes - 1, 3);
    auto const f = [&](Vec3d p) {
      return std::pow(p.x - 1, degree) + 2 * std::pow(p.y + 1, degree) * std::pow(p.z, degree);
    };
    auto const volume = sampled<double>(open_grid(nodes, nodes, nodes), f);
    auto const view = volume.view<double, CubicBspline, 3>(0, 0);
    double const end = nodes - 1;
    for (Vec3d p : {Vec3d{0, 0, 0}, Vec3d{end, end, end}, Vec3d{0.3, 0.7, 0.9}, Vec3d{end - 0.2, 0, end - 0.6}}) {
      EXPECT_NEAR(view.sample(p).refractivity, f(p), 1e-11) << nodes;
      EXPECT_NEAR(view.sample(p).gradient.x, degree * std::pow(p.x - 1, degree - 1), 1e-11) << nodes;
    }
  }
}

TEST(LinearVolume, ReproducesTrilinearFunctions) {
  auto const f = [](Vec3d p) {
    return 1 + 2 * p.x - 3 * p.y + p.z + p.x * p.y - 2 * p.y * p.z + 0.5 * p.x * p.y * p.z;
  };
  for (int nodes : {2, 3, 5}) {
    auto const volume = sampled<float>(open_grid(nodes, nodes, nodes), f, false);
    auto const view = volume.view<double, Linear, 3>(0, 0);
    for (double x = 0; x <= nodes - 1; x += 0.25) {
      Vec3d const p{x, nodes - 1 - x, 0.5 * x};
      auto const at = view.sample(p);
      EXPECT_NEAR(at.refractivity, f(p), 1e-13);
      EXPECT_NEAR(at.gradient.x, 2 + p.y + 0.5 * p.y * p.z, 1e-13);
      EXPECT_NEAR(at.gradient.y, -3 + p.x - 2 * p.z + 0.5 * p.x * p.z, 1e-13);
      EXPECT_NEAR(at.gradient.z, 1 - 2 * p.y + 0.5 * p.x * p.y, 1e-13);
    }
  }
}

// --- positions of the nodes

TEST(GriddedIndex, NodeIOfNIsAtNodeI) {
  RegularGrid const grid = open_grid(9, 8, 7, {0.5e-3, 0.25e-3, 2e-3}, {-1e-3, 3e-3, -5e-3});
  auto const f = [&](Vec3d p) { return rough({p.x / 0.5e-3, p.y / 0.25e-3, p.z / 2e-3}); };
  auto const spline = sampled<float>(grid, f);
  auto const linear = sampled<float>(grid, f, false);
  auto const a = spline.view<double, CubicBspline, 3>(0, 0);
  auto const b = linear.view<double, Linear, 3>(0, 0);
  for (int k = 0; k < 7; ++k) {
    for (int j = 0; j < 8; ++j) {
      for (int i = 0; i < 9; ++i) {
        Vec3d const node{-1e-3 + i * 0.5e-3, 3e-3 + j * 0.25e-3, -5e-3 + k * 2e-3};
        EXPECT_NEAR(a.sample(node).refractivity, f(node), 2e-10);  // 1e-4 in float, filtered three times
        EXPECT_NEAR(b.sample(node).refractivity, f(node), 2e-11);
      }
    }
  }
  Bounds<double> const box = a.bounds();
  EXPECT_EQ(box.low, (Vec3d{-1e-3, 3e-3, -5e-3}));
  EXPECT_EQ(box.high, (Vec3d{-1e-3 + 8 * 0.5e-3, 3e-3 + 7 * 0.25e-3, -5e-3 + 6 * 2e-3}));
}

template <class View>
void expect_consistent_gradient(View const& view, std::initializer_list<Vec3d> points, double tolerance) {
  double const h = 1e-4;
  for (Vec3d p : points) {
    auto const at = view.sample(p);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d step{};
      step[axis] = h;
      double const difference = (view.sample(p + step).refractivity - view.sample(p - step).refractivity) / (2 * h);
      EXPECT_NEAR(at.gradient[axis], difference, tolerance) << "axis " << axis;
    }
  }
}

// D = n grad n is consistent with n only if the gradient is the derivative of the interpolant. Central difference:
// error of h^2/6 times the third derivative (1e-4), and rounding of values of 1e-4 over h, 1e-16.
TEST(GriddedIndex, GradientIsTheDerivativeOfTheValue) {
  auto const points = {Vec3d{1.3, 2.2, 3.7}, Vec3d{0.01, 0.5, 0.5}, Vec3d{4.5, 4.99, 2.5}, Vec3d{3.25, 1.75, 4.9}};
  auto const spline = sampled<float>(open_grid(6, 6, 6), rough);
  expect_consistent_gradient(spline.view<double, CubicBspline, 3>(0, 0), points, 1e-11);
  auto const linear = sampled<float>(open_grid(6, 6, 6), rough, false);
  expect_consistent_gradient(linear.view<double, Linear, 3>(0, 0), points, 1e-11);
  auto const plane = sampled<double>(open_grid(6, 6, 1), rough);
  expect_consistent_gradient(plane.view<double, CubicBspline, 2>(-9, 9), points, 1e-11);
}

// --- periodic axes

RegularGrid periodic_grid(int nx, int ny, int nz, std::array<bool, 3> periodic) {
  RegularGrid grid = open_grid(nx, ny, nz);
  grid.periodic = periodic;
  return grid;
}

TEST(PeriodicGrid, WrapsWithPeriodNTimesSpacing) {
  auto const f = [](Vec3d p) { return rough({std::fmod(p.x, 8), std::fmod(p.y, 7), p.z}); };
  auto const spline = sampled<float>(periodic_grid(8, 7, 6, {true, true, true}), f);
  auto const view = spline.view<double, CubicBspline, 3>(0, 0);
  auto const linear = sampled<float>(periodic_grid(8, 7, 6, {true, true, true}), f, false);
  auto const flat = linear.view<double, Linear, 3>(0, 0);
  // dyadic positions, so that adding periods is exact
  for (Vec3d p : {Vec3d{0, 0, 0}, Vec3d{7.75, 6.5, 5.25}, Vec3d{3.125, 0.25, 2.5}}) {
    for (Vec3d shift : {Vec3d{8, 0, 0}, Vec3d{-16, 7, 0}, Vec3d{0, -21, 6}, Vec3d{0, 0, -12}}) {
      EXPECT_EQ(view.sample(p).refractivity, view.sample(p + shift).refractivity);
      EXPECT_EQ(view.sample(p).gradient, view.sample(p + shift).gradient);
      EXPECT_EQ(flat.sample(p).refractivity, flat.sample(p + shift).refractivity);
    }
  }
  // linear interpolation connects the last node with the first
  EXPECT_NEAR(flat.sample({7.5, 0, 0}).refractivity, 0.5 * (f({7, 0, 0}) + f({0, 0, 0})), 1e-11);
  // and the spline is smooth across the boundary of the period
  Vec3d const seam{8, 2.3, 1.1};
  double const e = 1e-7;
  EXPECT_NEAR(view.sample(seam - Vec3d{e, 0, 0}).gradient.x, view.sample(seam + Vec3d{e, 0, 0}).gradient.x, 1e-10);
}

// A sampled sine on a periodic axis: the error of its spline is of order h^4 in the value and h^3 in the slope (2e-11
// for float values).
TEST(PeriodicGrid, SplineOfASineConverges) {
  auto const worst = [](int nodes) {
    double const q = 2 * pi / nodes;
    auto const volume = sampled<double>(periodic_grid(nodes, 4, 1, {true, false, false}),
                                        [&](Vec3d p) { return 1e-4 * std::sin(q * p.x); });
    auto const view = volume.view<double, CubicBspline, 2>(-1, 1);
    std::pair<double, double> error{};
    for (double x = 0; x < nodes; x += 0.125) {
      auto const at = view.sample({x, 1.5, 0});
      error.first = std::max(error.first, std::abs(at.refractivity / 1e-4 - std::sin(q * x)));
      error.second = std::max(error.second, std::abs(at.gradient.x / (1e-4 * q) - std::cos(q * x)));
    }
    return error;
  };
  auto const [value_8, slope_8] = worst(8);
  auto const [value_16, slope_16] = worst(16);
  auto const [value_32, slope_32] = worst(32);
  EXPECT_NEAR(std::log2(value_8 / value_16), 4, 0.2);
  EXPECT_NEAR(std::log2(value_16 / value_32), 4, 0.2);
  EXPECT_NEAR(std::log2(slope_8 / slope_16), 3, 0.2);
  EXPECT_NEAR(std::log2(slope_16 / slope_32), 3, 0.2);
}

TEST(PeriodicGrid, IsEndlessAcrossTheViewAndOnePeriodDeep) {
  auto const volume = sampled<float>(periodic_grid(8, 8, 6, {true, false, true}), rough);
  Bounds<double> const box = volume.view<double, CubicBspline, 3>(0, 0).bounds();
  EXPECT_EQ(box.low.x, -unbounded);
  EXPECT_EQ(box.high.x, unbounded);
  EXPECT_EQ(box.high.y, 7);
  EXPECT_EQ(box.low.z, -0.5);
  EXPECT_EQ(box.high.z, 5.5);
}

// --- an extruded plane equals a stack of copies of it

TEST(ExtrudedPlane, EqualsTheStackedVolume) {
  Vec3d const spacing{0.5e-3, 0.5e-3, 1e-3}, origin{-4e-3, -4e-3, -5e-3};
  auto const f = [](Vec3d p) { return 2.7e-4 + 1e-5 * std::sin(1100 * p.x) * std::cos(900 * p.y + 1); };
  for (bool spline : {true, false}) {
    auto const plane = sampled<double>(open_grid(17, 17, 1, spacing, {origin.x, origin.y, 0}), f, spline);
    auto const stack = sampled<float>(open_grid(17, 17, 11, spacing, origin), f, spline);
    Ray<double> const start{{1e-3, -5e-4, -0.25}, normalized(Vec3d{0.004, 0.002, 1})};
    TracingOptions<double> const options{1e-4, 2.7e-4, Integrator::rk4, Faces::matched};
    auto const moved = [&](auto const& medium) {
      return apparent_ray(start, trace_medium(medium, options, start)).position - start.position;
    };
    Vec3d const a = spline ? moved(plane.view<double, CubicBspline, 2>(-5e-3, 5e-3))
                           : moved(plane.view<double, Linear, 2>(-5e-3, 5e-3));
    Vec3d const b =
        spline ? moved(stack.view<double, CubicBspline, 3>(0, 0)) : moved(stack.view<double, Linear, 3>(0, 0));
    EXPECT_GT(length(a), 1e-6);
    EXPECT_LT(length(a - b), 2e-6 * length(a)) << "the volume keeps n - 1 in float";
  }
}

// --- scale, bounds and memory

TEST(RefractiveIndexVolume, ScaleAndShiftMakeRefractivities) {
  RegularGrid const grid = open_grid(3, 3, 3);
  auto const ramp = [](int first, int count, std::span<double> out) {
    for (int i = 0; i < 9 * count; ++i) out[static_cast<std::size_t>(i)] = static_cast<float>(10 + i + 9 * first);
  };
  RefractiveIndexVolume<float> const volume(grid, RefractiveIndexVolume<float>::Interpolation::trilinear, 0.5, -1,
                                            ramp);
  auto const view = volume.view<double, Linear, 3>(0, 0);
  EXPECT_EQ(view.sample({0, 0, 0}).refractivity, 4);
  EXPECT_EQ(view.sample({2, 2, 2}).refractivity, 0.5 * 36 - 1);
  EXPECT_EQ(view.sample({1, 0, 0}).gradient, (Vec3d{0.5, 1.5, 4.5}));
  EXPECT_EQ(volume.lowest(), 4);
  EXPECT_EQ(volume.highest(), 17);
  EXPECT_NEAR(volume.steepest(), std::sqrt(0.25 + 2.25 + 20.25), 1e-12);
}

TEST(RefractiveIndexVolume, SteepestBoundsEveryGradient) {
  for (bool periodic : {false, true}) {
    auto const volume = sampled<float>(periodic_grid(8, 8, 8, {periodic, periodic, periodic}), rough);
    auto const view = volume.view<double, CubicBspline, 3>(0, 0);
    double largest = 0;
    for (double x = 0; x <= 7; x += 0.2) {
      for (double y = 0; y <= 7; y += 0.2) {
        for (double z = 0; z <= 7; z += 0.2) largest = std::max(largest, length(view.sample({x, y, z}).gradient));
      }
    }
    EXPECT_LE(largest, volume.steepest());
    EXPECT_GT(largest, 0.2 * volume.steepest());
  }
}

TEST(RefractiveIndexVolume, LargeVolumesNeedLittleMoreThanTheirSize) {
  double const size = 1024.0 * 1024 * 1024 * sizeof(float);
  for (bool periodic : {false, true}) {
    RegularGrid const grid = periodic_grid(1024, 1024, 1024, {periodic, periodic, periodic});
    double const needed = static_cast<double>(RefractiveIndexVolume<float>::bytes_needed(grid));
    EXPECT_GE(needed, size);
    EXPECT_LT(needed, 1.3 * size);
  }
  // The volume has one additional node at each end of every axis.
  EXPECT_EQ(RefractiveIndexVolume<float>::bytes_needed(open_grid(5, 6, 7)), 7 * 8 * 9 * sizeof(float));
}

}  // namespace
}  // namespace gladstone
