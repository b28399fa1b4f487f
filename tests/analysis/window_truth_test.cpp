#include "analysis/errors/window_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/scattered_grid.h"
#include "render/base/parallel.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

std::vector<Vec2d> random_points(std::size_t count, double size) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, size);
  std::vector<Vec2d> points(count);
  for (Vec2d& p : points) p = {uniform(random), uniform(random)};
  return points;
}

std::vector<Vec2d> displaced(std::vector<Vec2d> const& points) {
  std::vector<Vec2d> d;
  for (Vec2d const& p : points) d.push_back({std::sin(0.1 * p.x) + 0.01 * p.y, 2.0 * std::cos(0.07 * p.y)});
  return d;
}

// Three dots with fluxes 1, 2, 3 at weights exp(-r^2/(2 sigma^2)), sigma = 4: T = sum f^2 W^2 d / sum f^2 W^2.
TEST(WindowTruth, WeighsWithSquaredWeightAndSquaredFlux) {
  std::vector<Vec2d> const position{{10.0, 10.0}, {12.0, 10.0}, {10.0, 13.0}};
  std::vector<Vec2d> const d{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 2.0}};
  std::vector<double> const flux{1.0, 2.0, 3.0};
  std::vector<Vec2d> const centre{{10.0, 10.0}};
  WindowTruth const truth = window_truth(position, d, flux, centre, gaussian_window(4.0, 16.0), TruthAt::reference);
  double const w1 = 1.0, w2 = 4.0 * std::exp(-4.0 / 16.0), w3 = 9.0 * std::exp(-9.0 / 16.0);
  EXPECT_NEAR(truth.displacement_px[0].x, (w1 - w3) / (w1 + w2 + w3), 1e-15);
  EXPECT_NEAR(truth.displacement_px[0].y, (w2 + 2.0 * w3) / (w1 + w2 + w3), 1e-15);
}

// Dots at x = 0..63 move by d = 0.1 x; at mid-position they stand at 1.05 x, so the field there is d = x_mid/10.5 and
// a symmetric window over a lattice sees the value at its centre, the dot x = 20 standing at 21.
TEST(WindowTruth, CountsDotsAtMidPosition) {
  std::vector<Vec2d> position, d;
  for (int x = 0; x < 64; ++x) {
    for (int y = 0; y < 8; ++y) {
      position.push_back({static_cast<double>(x), static_cast<double>(y)});
      d.push_back({0.1 * x, 0.0});
    }
  }
  std::vector<Vec2d> const centre{{21.0, 3.5}};
  WindowTruth const mid = window_truth(position, d, {}, centre, gaussian_window(4.0, 12.0));
  EXPECT_NEAR(mid.displacement_px[0].x, 2.0, 1e-13);
  WindowTruth const one_sided = window_truth(position, d, {}, centre, gaussian_window(4.0, 12.0), TruthAt::reference);
  EXPECT_NEAR(one_sided.displacement_px[0].x, 2.1, 1e-13);
}

TEST(WindowTruth, LeavesOutWindowsWithFewerThanThreeDots) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec2d> const position{{0, 0}, {1, 0}, {2, 0}, {30, 0}, {31, 0}, {32, 0}, {60, 0}};
  std::vector<Vec2d> d(7, Vec2d{1.0, 1.0});
  d[5] = {nan, 1.0};  // a dot whose rays were all lost
  std::vector<Vec2d> const centres{{1, 0}, {31, 0}, {60, 0}, {500, 500}};
  WindowTruth const truth = window_truth(position, d, {}, centres, top_hat_window(8.0));
  EXPECT_EQ(truth.left_out, 3u);
  EXPECT_EQ(truth.displacement_px[0], (Vec2d{1.0, 1.0}));
  for (std::size_t i : {1u, 2u, 3u}) EXPECT_TRUE(std::isnan(truth.displacement_px[i].x));
}

TEST(WindowTruth, OfNoDotsLeavesAllOut) {
  std::vector<Vec2d> const centres(3);
  EXPECT_EQ(window_truth({}, {}, {}, centres, top_hat_window(8.0)).left_out, 3u);
}

// The cell grid finds exactly the dots of the support: the same sums as over all dots, to rounding.
TEST(WindowTruth, AgreesWithTheSumOverAllDotsForAnyNumberOfThreads) {
  std::vector<Vec2d> const position = random_points(2000, 200.0);
  std::vector<Vec2d> const d = displaced(position);
  std::vector<Vec2d> const centres = random_points(300, 220.0);
  WindowWeight const weight = gaussian_window(6.0, 16.0);
  int const before = thread_count();
  set_thread_count(1);
  WindowTruth const truth = window_truth(position, d, {}, centres, weight);
  set_thread_count(7);
  WindowTruth const again = window_truth(position, d, {}, centres, weight);
  set_thread_count(before);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    Vec2d sum{};
    double total = 0.0;
    int dots = 0;
    for (std::size_t k = 0; k < position.size(); ++k) {
      Vec2d const o = position[k] + 0.5 * d[k] - centres[i];
      if (std::abs(o.x) > 16.0 || std::abs(o.y) > 16.0) continue;
      double const w = std::exp(-dot(o, o) / 36.0);
      sum += w * d[k];
      total += w;
      ++dots;
    }
    if (dots < 3) {
      EXPECT_TRUE(std::isnan(truth.displacement_px[i].x));
      continue;
    }
    EXPECT_EQ(truth.displacement_px[i], again.displacement_px[i]);
    EXPECT_NEAR(truth.displacement_px[i].x, sum.x / total, 1e-12);
    EXPECT_NEAR(truth.displacement_px[i].y, sum.y / total, 1e-12);
  }
}

// A linear field is its own plane: at the window's centre it has exactly its value there, wherever the dots are, and
// with three of them as with hundreds. The mean differs by the gradient times the distance of their centre.
TEST(DeformedWindowTruth, OfALinearFieldIsItsValueAtTheCentre) {
  auto const field = [](Vec2d p) { return Vec2d{0.5 + 0.02 * p.x - 0.03 * p.y, -1.0 + 0.04 * p.y}; };
  std::vector<Vec2d> position = random_points(300, 100.0);
  position.insert(position.end(), {{203.0, 204.0}, {212.0, 205.0}, {206.0, 213.0}});
  std::vector<Vec2d> d;
  std::vector<double> flux;
  for (Vec2d const& p : position) {
    d.push_back(field(p));
    flux.push_back(1.0 + 0.3 * std::sin(p.x));
  }
  std::vector<Vec2d> const centres{{50.0, 50.0}, {3.0, 60.0}, {200.0, 200.0}};
  WindowWeight const weight = gaussian_window(8.0, 16.0);
  WindowTruth const mean = window_truth(position, d, flux, centres, weight, TruthAt::reference);
  WindowTruth const plane = deformed_window_truth(position, d, flux, centres, weight, TruthAt::reference);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    EXPECT_NEAR(plane.displacement_px[i].x, field(centres[i]).x, 1e-12) << i;
    EXPECT_NEAR(plane.displacement_px[i].y, field(centres[i]).y, 1e-12) << i;
  }
  EXPECT_GT(length(mean.displacement_px[1] - field(centres[1])), 0.01);  // dots on one side alone
  EXPECT_GT(length(mean.displacement_px[2] - field(centres[2])), 0.1);
}

// d = k x^2/2 over a lattice that is symmetric about the window: no slope there, and the mean is k/2 times the second
// moment of W^2 about the centre. About x = x0, where the field slopes, the plane has the same on top of the value.
TEST(DeformedWindowTruth, OfAQuadraticFieldAddsCurvatureTimesTheSecondMoment) {
  double const k = 0.01, sigma = 4.0, half_width = 12.0;
  std::vector<Vec2d> position, d;
  for (int x = 0; x <= 80; ++x)
    for (int y = 0; y <= 40; ++y) {
      position.push_back({static_cast<double>(x), static_cast<double>(y)});
      d.push_back({0.5 * k * (x - 20.0) * (x - 20.0), 0.0});
    }
  double moment = 0.0, sum = 0.0;
  for (int x = -12; x <= 12; ++x) {
    double const w = std::exp(-x * x / (sigma * sigma));
    moment += w * x * x;
    sum += w;
  }
  moment /= sum;
  std::vector<Vec2d> const centres{{20.0, 20.0}, {50.0, 20.0}};
  WindowTruth const plane =
      deformed_window_truth(position, d, {}, centres, gaussian_window(sigma, half_width), TruthAt::reference);
  EXPECT_NEAR(plane.displacement_px[0].x, 0.5 * k * moment, 1e-12);
  EXPECT_NEAR(plane.displacement_px[1].x, 0.5 * k * (900.0 + moment), 1e-10);
}

// Where dots stand in line nothing tells the gradient across: the mean. Two dots are too few for either.
TEST(DeformedWindowTruth, IsTheMeanOfDotsInLine) {
  std::vector<Vec2d> const position{{1, 2}, {2, 3}, {4, 5}, {30, 0}, {31, 0}};
  std::vector<Vec2d> const d{{1, 0}, {2, 1}, {6, 2}, {1, 1}, {1, 1}};
  std::vector<Vec2d> const centres{{0, 0}, {30, 0}};
  WindowTruth const truth = deformed_window_truth(position, d, {}, centres, top_hat_window(16.0), TruthAt::reference);
  EXPECT_NEAR(truth.displacement_px[0].x, 3.0, 1e-15);
  EXPECT_NEAR(truth.displacement_px[0].y, 1.0, 1e-15);
  EXPECT_EQ(truth.left_out, 1u);
  EXPECT_TRUE(std::isnan(truth.displacement_px[1].x));
}

// What decides which truth holds: frames of a shear, without noise, so coarse with dots that a window's dots lie off
// its centre. One pass measures their mean, several the value at the centre.
TEST(DeformedWindowTruth, IsWhatSeveralPassesMeasure) {
  auto const shear = [](Vec2d p) { return Vec2d{0.02 * (p.y - 127.5), 0.0}; };
  ParticlePair const pair = render_particle_pair({.particles_per_px = 10.0 / 1024.0, .seed = 3}, shear);
  for (bool const several : {false, true}) {
    CorrelationSettings settings;
    if (!several) settings.window_px = {32};
    DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    WindowWeight const weight{[&](double dx, double dy) { return window_weight(settings, dx, dy); },
                              window_support_px(settings)};
    auto const rms_against = [&](auto const& truth_of) {
      WindowTruth const truth = truth_of(pair.dot_reference_px, pair.dot_displacement_px, pair.dot_light,
                                         field.position_px, weight, TruthAt::mid_position);
      double sum = 0.0, count = 0.0;
      for (std::size_t i = 0; i < field.size(); ++i) {
        Vec2d const at = field.position_px[i];
        if (field.status[i] != VectorStatus::valid || std::min({at.x, at.y, 255 - at.x, 255 - at.y}) < 32) continue;
        double const error = field.displacement_px[i].x - truth.displacement_px[i].x;
        sum += error * error;
        count += 1.0;
      }
      return std::sqrt(sum / count);
    };
    double const mean = rms_against(window_truth), plane = rms_against(deformed_window_truth);
    EXPECT_GT(several ? mean : plane, 2.0 * (several ? plane : mean)) << several << ' ' << mean << ' ' << plane;
  }
}

// Local linear regression reproduces a plane wherever it has dots, at the edges as well: rounding only.
TEST(MapScattered, ReproducesAPlane) {
  std::vector<Vec2d> const position = random_points(1500, 128.0);
  std::vector<Vec2d> d;
  for (Vec2d const& p : position) d.push_back({0.5 + 0.02 * p.x - 0.03 * p.y, 0.01 * p.y});
  MapGrid const grid{65, 65, {0.0, 0.0}, 2.0};
  DisplacementMaps const maps = map_scattered(position, d, grid);
  for (int row = 0; row < 65; ++row) {
    for (int column = 0; column < 65; ++column) {
      EXPECT_NEAR(maps.u_px(column, row), 0.5 + 0.04 * column - 0.06 * row, 1e-9);
      EXPECT_NEAR(maps.v_px(column, row), 0.02 * row, 1e-9);
    }
  }
}

TEST(MapScattered, IsNotANumberFarFromEveryDot) {
  std::vector<Vec2d> const position = random_points(200, 20.0);
  DisplacementMaps const maps = map_scattered(position, displaced(position), {2, 1, {10.0, 10.0}, 200.0});
  EXPECT_TRUE(std::isfinite(maps.u_px(0, 0)));
  EXPECT_TRUE(std::isnan(maps.u_px(1, 0)));
}

}  // namespace
}  // namespace gladstone
