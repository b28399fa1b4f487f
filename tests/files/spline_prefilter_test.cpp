#include "render/files/fields/spline_prefilter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "render/base/units.h"
#include "render/files/fields/interpolation.h"

namespace gladstone {
namespace {

struct Value {
  double value, slope;
};

/// Evaluates the spline at u (in cells from node 0). @param line  coefficients, beginning with one ghost
Value spline_at(std::vector<double> const& line, int nodes, double u) {
  int cell = static_cast<int>(std::floor(u));
  cell = std::min(std::max(cell, 0), nodes - 2);
  double w[4], d[4];
  CubicBspline::weigh(u - cell, w, d);
  Value at{};
  for (int i = 0; i < 4; ++i) {
    double const c = line[static_cast<std::size_t>(cell + CubicBspline::first + i + 1)];
    at.value += w[i] * c;
    at.slope += d[i] * c;
  }
  return at;
}

std::vector<double> open_spline(int nodes, std::function<double(double)> const& f) {
  std::vector<double> line(static_cast<std::size_t>(nodes) + 2), scratch(static_cast<std::size_t>(nodes));
  for (int i = 0; i < nodes; ++i) line[static_cast<std::size_t>(i) + 1] = f(i);
  prefilter_open(line, scratch);
  return line;
}

/// Like open_spline(), for a periodic spline with the ghosts that a volume copies: one before, two after.
std::vector<double> periodic_spline(int nodes, std::function<double(double)> const& f) {
  std::vector<double> values(static_cast<std::size_t>(nodes));
  for (int i = 0; i < nodes; ++i) values[static_cast<std::size_t>(i)] = f(i);
  prefilter_periodic(values);
  std::vector<double> line;
  for (int i = -1; i < nodes + 2; ++i) line.push_back(values[static_cast<std::size_t>((i + nodes) % nodes)]);
  return line;
}

TEST(CubicBsplineWeights, SumToOneAndReproduceALine) {
  for (double u : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    double w[4], d[4];
    CubicBspline::weigh(u, w, d);
    EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-15);
    EXPECT_NEAR(d[0] + d[1] + d[2] + d[3], 0, 1e-15);
    EXPECT_NEAR(-w[0] + w[2] + 2 * w[3], u, 1e-15);  // the coefficients of a linear function are its values
    EXPECT_NEAR(-d[0] + d[2] + 2 * d[3], 1, 1e-15);
  }
}

// Not-a-knot ends: with N nodes, every polynomial up to degree min(3, N - 1) and its derivative are reproduced from the
// first node to the last. Tolerance: about 100 roundings of values up to 4 N^3.
TEST(OpenSpline, ReproducesPolynomialsUpToTheEdge) {
  for (int nodes : {2, 3, 4, 5, 6, 7, 12, 65}) {
    for (int degree = 0; degree <= std::min(3, nodes - 1); ++degree) {
      auto const f = [&](double x) { return 2 - 3 * std::pow(x - 1.3, degree); };
      auto const slope = [&](double x) { return degree == 0 ? 0.0 : -3 * degree * std::pow(x - 1.3, degree - 1); };
      std::vector<double> const line = open_spline(nodes, f);
      double const scale = 4 + std::pow(nodes, degree);
      for (double u = 0; u <= nodes - 1; u += 0.125) {
        Value const at = spline_at(line, nodes, u);
        EXPECT_NEAR(at.value, f(u), 3e-14 * scale) << nodes << " nodes, degree " << degree << " at " << u;
        EXPECT_NEAR(at.slope, slope(u), 6e-14 * scale) << nodes << " nodes, degree " << degree << " at " << u;
      }
    }
  }
}

TEST(OpenSpline, InterpolatesItsNodesWhateverTheyHold) {
  for (int nodes = 1; nodes <= 20; ++nodes) {
    auto const f = [](double x) { return std::fmod(x * x * 37.7 + 11.3, 5.0) - 2; };
    std::vector<double> const line = open_spline(nodes, f);
    if (nodes == 1) {
      EXPECT_EQ(line, (std::vector<double>{f(0), f(0), f(0)}));
      continue;
    }
    for (int i = 0; i < nodes; ++i) EXPECT_NEAR(spline_at(line, nodes, i).value, f(i), 2e-14) << nodes << " " << i;
  }
}

TEST(OpenSpline, ThirdDerivativeDoesNotJumpAtTheSecondNode) {
  // the not-a-knot condition: the fourth difference of the coefficients about nodes 1 and N - 2 vanishes
  std::vector<double> const c = open_spline(9, [](double x) { return std::sin(2.1 * x); });
  auto const fourth = [&](std::size_t i) { return c[i - 2] - 4 * c[i - 1] + 6 * c[i] - 4 * c[i + 1] + c[i + 2]; };
  EXPECT_NEAR(fourth(2), 0, 1e-14);
  EXPECT_NEAR(fourth(8), 0, 1e-14);
  EXPECT_GT(std::abs(fourth(5)), 0.1);
}

// The transfer function of the discrete B-spline is 4/6 + 2/6 cos(q): the coefficients of a sampled cosine are known
// exactly for any N.
TEST(PeriodicSpline, CoefficientsOfACosineAreExact) {
  for (int nodes : {1, 2, 3, 4, 5, 8, 31, 200}) {
    for (int wave = 0; wave <= nodes / 2; wave = wave < 3 ? wave + 1 : 2 * wave) {
      double const q = 2 * pi * wave / nodes;
      std::vector<double> c(static_cast<std::size_t>(nodes));
      for (int i = 0; i < nodes; ++i) c[static_cast<std::size_t>(i)] = std::cos(q * i + 0.3);
      prefilter_periodic(c);
      for (int i = 0; i < nodes; ++i) {
        // tolerance 2e-13, since the argument q i grows to 600
        EXPECT_NEAR(c[static_cast<std::size_t>(i)], std::cos(q * i + 0.3) * 6 / (4 + 2 * std::cos(q)), 2e-13)
            << nodes << " nodes, wave " << wave;
      }
    }
  }
}

// Between the nodes, the error of the spline of a sine is O(h^4), that of its slope O(h^3).
TEST(PeriodicSpline, ConvergesToASineWithItsOrders) {
  double value_before = 0, slope_before = 0;
  for (int nodes = 8; nodes <= 128; nodes *= 2) {
    double const q = 2 * pi / nodes;
    std::vector<double> const line = periodic_spline(nodes, [&](double x) { return std::sin(q * x); });
    double value = 0, slope = 0;
    for (double u = 0; u < nodes; u += 1.0 / 16) {
      double w[4], d[4];
      int const cell = static_cast<int>(u);
      CubicBspline::weigh(u - cell, w, d);
      Value at{};
      for (int i = 0; i < 4; ++i) {
        at.value += w[i] * line[static_cast<std::size_t>(cell + i)];
        at.slope += d[i] * line[static_cast<std::size_t>(cell + i)];
      }
      value = std::max(value, std::abs(at.value - std::sin(q * u)));
      slope = std::max(slope, std::abs(at.slope / q - std::cos(q * u)));
    }
    if (value_before > 0) {
      EXPECT_NEAR(std::log2(value_before / value), 4, 0.15) << nodes;
      EXPECT_NEAR(std::log2(slope_before / slope), 3, 0.15) << nodes;
    }
    value_before = value;
    slope_before = slope;
  }
  EXPECT_LT(value_before, 1e-7);
}

}  // namespace
}  // namespace gladstone
