#include "analysis/errors/window_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <tuple>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/deformed_window_truth.h"
#include "analysis/errors/scattered_grid.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
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

/// W = exp(-(dx^2 + dy^2)/(2 sigma^2)) within the square |dx|, |dy| <= half_width.
WindowWeight gaussian_window(double sigma_px, double half_width_px) {
  return {[=](double dx, double dy) { return std::exp(-0.5 * (dx * dx + dy * dy) / (sigma_px * sigma_px)); },
          half_width_px};
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

// Dots at x = 0..63 move by d = 0.1 x. Their mid-positions are 1.05 x, so the field there is d = x_mid/10.5, and a
// symmetric window over a lattice gives the value at its centre, where the dot x = 20 is at 21.
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
  WindowTruth const truth = window_truth(position, d, {}, centres, correlation_window(WindowWeighting::uniform, 8.0));
  EXPECT_EQ(truth.left_out, 3u);
  EXPECT_EQ(truth.displacement_px[0], (Vec2d{1.0, 1.0}));
  for (std::size_t i : {1u, 2u, 3u}) EXPECT_TRUE(std::isnan(truth.displacement_px[i].x));
}

TEST(WindowTruth, OfNoDotsLeavesAllOut) {
  std::vector<Vec2d> const centres(3);
  EXPECT_EQ(window_truth({}, {}, {}, centres, correlation_window(WindowWeighting::uniform, 8.0)).left_out, 3u);
}

// The cell grid finds exactly the dots of the window: the same sums as over all dots, to rounding.
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

// With one pass nothing is deformed: the result is the mean of the window's dots, bit by bit.
TEST(DeformedWindowTruth, OfOnePassIsTheMeanOfTheWindow) {
  CorrelationSettings settings;
  settings.window_px = {32};
  std::vector<Vec2d> const position = random_points(300, 128.0), centres{{50.0, 50.0}, {3.0, 60.0}, {400.0, 0.0}};
  std::vector<Vec2d> d;
  std::vector<double> flux;
  for (Vec2d const& p : position) {
    d.push_back({0.02 * p.x, std::sin(p.y)});
    flux.push_back(1.0 + 0.3 * std::sin(p.x));
  }
  for (TruthAt const at : {TruthAt::mid_position, TruthAt::reference}) {
    WindowTruth const one = deformed_window_truth(position, d, flux, centres, settings, 128, 128, at);
    WindowTruth const mean =
        window_truth(position, d, flux, centres, correlation_window(WindowWeighting::gaussian, 32), at);
    EXPECT_EQ(one.left_out, 1u);
    for (std::size_t i = 0; i + 1 < centres.size(); ++i) EXPECT_EQ(one.displacement_px[i], mean.displacement_px[i]);
    EXPECT_TRUE(std::isnan(one.displacement_px[2].x));
  }
}

// A lattice of dots is symmetric about every window in the interior, so that a linear field has no residual for later
// passes. A dot without a displacement, a window that does not fit the frame and a centre that is NaN have no effect.
TEST(DeformedWindowTruth, OfALinearFieldIsItsValueAtTheCentre) {
  auto const field = [](Vec2d p) { return Vec2d{0.5 + 0.02 * p.x - 0.03 * p.y, -1.0 + 0.04 * p.y}; };
  std::vector<Vec2d> position, d;
  for (int y = -40; y < 168; ++y)
    for (int x = -40; x < 168; ++x) {
      position.push_back({static_cast<double>(x), static_cast<double>(y)});
      d.push_back(field(position.back()));
    }
  double const nan = std::nan("");
  position.push_back({64.0, 64.0});
  d.push_back({nan, nan});
  CorrelationSettings settings;
  settings.window_px = {256, 32, 24};
  std::vector<Vec2d> const centres{{50.5, 50.5}, {11.5, 60.5}, {nan, 60.0}};
  WindowTruth const truth = deformed_window_truth(position, d, {}, centres, settings, 128, 128, TruthAt::reference);
  EXPECT_EQ(truth.left_out, 1u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(truth.displacement_px[i].x, field(centres[i]).x, 1e-12) << i;
    EXPECT_NEAR(truth.displacement_px[i].y, field(centres[i]).y, 1e-12) << i;
  }
}

// The gain of a wave, for dots as dense as pixels. A window transmits h = exp(-pi (w/L)^2/2), the transform of W^2
// (truncated at exp(-2 pi), 2 parts in 1000). The next pass transmits its own h of the residual 1 - h: g_k = h_k + (1 -
// h_k) p g_(k-1). With nodes on every second pixel of a wave of 96 px the predictor transmits p = 1 - s (1 - cos(2 pi
// spacing/L)), and cubic convolution transmits all of it; s = 1/4 before the last pass, and smaller before that, in
// inverse proportion to the spacing.
TEST(DeformedWindowTruth, GivesAWaveTheGainOfItsPasses) {
  constexpr double wave_px = 96.0;
  std::vector<Vec2d> position, d;
  for (int y = 0; y < 64; ++y)
    for (int x = -64; x < 256; ++x) {
      position.push_back({static_cast<double>(x), static_cast<double>(y)});
      d.push_back({0.0, std::cos(2.0 * pi * (x - 96.0) / wave_px)});
    }
  std::vector<Vec2d> const centre{{96.0, 32.0}};
  auto const window_gain = [](double window_px) { return std::exp(-0.5 * pi * std::pow(window_px / wave_px, 2)); };
  for (std::vector<int> const& windows : {std::vector{64}, std::vector{64, 32}, std::vector{64, 32, 16}}) {
    CorrelationSettings settings;
    settings.window_px = windows;
    settings.overlap = 0.95;  // spacing 3, 2, 1 px
    auto const spacing_px = [&](std::size_t pass) { return std::max(1.0, std::round(0.05 * windows[pass])); };
    double gain = window_gain(windows[0]);
    for (std::size_t pass = 1; pass < windows.size(); ++pass) {
      double const before = spacing_px(pass - 1), s = 0.25 * spacing_px(windows.size() - 2) / before;
      double const h = window_gain(windows[pass]), p = 1.0 - s * (1.0 - std::cos(2.0 * pi * before / wave_px));
      gain = h + (1.0 - h) * p * gain;
    }
    double const found =
        deformed_window_truth(position, d, {}, centre, settings, 192, 64, TruthAt::reference).displacement_px[0].y;
    EXPECT_NEAR(found, gain, 2e-3) << windows.size();
  }
}

// Noise-free frames show which truth is valid. In a shear with so few dots that their centroid differs from the window
// centre, one pass measures the mean of the dots, several passes the value at the centre; for a wave of 64 px several
// passes measure the part that their windows transmit.
TEST(DeformedWindowTruth, IsWhatThePassesMeasure) {
  auto const shear = [](Vec2d p) { return Vec2d{0.02 * (p.y - 127.5), 0.0}; };
  auto const wave = [](Vec2d p) { return Vec2d{0.0, 0.5 * std::sin(2.0 * pi * p.x / 64.0)}; };
  struct Of {
    std::function<Vec2d(Vec2d)> flow;
    double particles;  ///< in 32 x 32 px
    std::vector<int> windows;
    bool mean_is_right, place_is_right;
  };
  for (Of const& of : {Of{shear, 10.0, {32}, true, false}, Of{shear, 10.0, {64, 32, 24, 20}, false, true},
                       Of{wave, 40.0, {64, 32, 24, 20}, false, false}}) {
    ParticlePair const pair = render_particle_pair({.particles_per_px = of.particles / 1024.0, .seed = 3}, of.flow);
    CorrelationSettings settings;
    settings.window_px = of.windows;
    DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    auto const rms_against = [&](auto const& truth_at) {
      double sum = 0.0, count = 0.0;
      for (std::size_t i = 0; i < field.size(); ++i) {
        Vec2d const at = field.position_px[i];
        if (field.status[i] != VectorStatus::valid || std::min({at.x, at.y, 255 - at.x, 255 - at.y}) < 32) continue;
        Vec2d const error = field.displacement_px[i] - truth_at(i);
        sum += dot(error, error);
        count += 1.0;
      }
      return std::sqrt(sum / count);
    };
    auto const& [reference, moved, light] = std::tie(pair.dot_reference_px, pair.dot_displacement_px, pair.dot_light);
    WindowTruth const means = window_truth(reference, moved, light, field.position_px,
                                           correlation_window(WindowWeighting::gaussian, settings.window_px.back()));
    WindowTruth const passes = deformed_window_truth(reference, moved, light, field.position_px, settings, 256, 256);
    double const mean = rms_against([&](std::size_t i) { return means.displacement_px[i]; }),
                 place = rms_against([&](std::size_t i) { return of.flow(field.position_px[i]); }),
                 deformed = rms_against([&](std::size_t i) { return passes.displacement_px[i]; });
    EXPECT_LT(deformed, of.mean_is_right ? 1.001 * mean : 0.5 * mean) << mean;
    EXPECT_LT(deformed, of.place_is_right ? 1.1 * place : 0.5 * place) << place;
  }
}

// The sum of the weights over pixels is that of the nominal window, except for the part truncated beyond twice its
// width: erf(sqrt(pi)) = 0.9878 per axis.
TEST(CorrelationWindow, HasTheAreaOfTheNominalWindow) {
  for (WindowWeighting const weighting : {WindowWeighting::gaussian, WindowWeighting::uniform}) {
    WindowWeight const window = correlation_window(weighting, 32);
    double const half = window.half_width_px;
    EXPECT_EQ(half, weighting == WindowWeighting::gaussian ? 32.0 : 16.0);
    EXPECT_EQ(window.value(half + 0.5, 0.0), 0.0);
    EXPECT_DOUBLE_EQ(window.value(0.0, 0.0), 1.0);
    double sum = 0.0;
    for (double y = -half + 0.5; y < half; y += 1.0)
      for (double x = -half + 0.5; x < half; x += 1.0) sum += window.value(x, y);
    double const kept = weighting == WindowWeighting::gaussian ? std::erf(std::sqrt(pi)) : 1.0;
    EXPECT_NEAR(sum / (32.0 * 32.0), kept * kept, 1e-4);
  }
}

// Local linear regression reproduces a plane wherever there are dots, also at the edges: only rounding errors.
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
