#include "analysis/density/density_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/error.h"
#include "render/base/random_variates.h"
#include "tests/analysis/density/density_cases.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline density {
namespace {

ReferenceDensity zero_left_side(PlaneGrid const& grid) { return make_side_reference(grid, GridSide::left, 0.0); }

/// Blob whose displacement is noisier where gradients are steep and along a noisy band, as in measurements: sigma
/// varies by a factor of 11.
GradientMap noisy_map(int n) {
  GradientMap map = make_map(n, [](Vec2d p) { return blob_gradient(p); });
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    Vec2d const p = map.grid.position(static_cast<int>(i) % n, static_cast<int>(i) / n);
    bool const in_band = std::abs(p.y - 0.3) < 0.1;
    double const sigma = 0.05 + 0.06 * length(map.gradient[i]) / 8.0 + (in_band ? 0.45 : 0.0);
    map.sigma.push_back({sigma, 0.8 * sigma});
  }
  return map;
}

// Windows of m steps share the fraction 1 - |i|/m of their length: 0.6 overlap, m = 2.5, gives 0.6, 0.2, 0. The
// covariance of L z is L L^T.
TEST(WindowCorrelation, IsTheSharedAreaOfTheWindows) {
  WindowCorrelation const correlation(8, 6, WindowOverlap::from_fraction(0.6));
  auto const covariance = [&](int column_a, int row_a, int column_b, int row_b) {
    std::vector<double> a(48), b(48);
    a[static_cast<std::size_t>(row_a * 8 + column_a)] = b[static_cast<std::size_t>(row_b * 8 + column_b)] = 1.0;
    a = correlation.correlate_transposed(a);
    b = correlation.correlate_transposed(b);
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  EXPECT_NEAR(covariance(5, 4, 5, 4), 1.0, 1e-12);
  EXPECT_NEAR(covariance(5, 4, 4, 4), 0.6, 1e-12);
  EXPECT_NEAR(covariance(5, 4, 5, 2), 0.2, 1e-12);
  EXPECT_NEAR(covariance(5, 4, 4, 5), 0.36, 1e-12);
  EXPECT_NEAR(covariance(5, 4, 2, 4), 0.0, 1e-12);
}

TEST(WindowCorrelation, TransposesItself) {
  WindowCorrelation const correlation(7, 5, {3.0, 1.7});
  std::vector<double> a(35), b(35);
  for (std::size_t i = 0; i < 35; ++i) {
    a[i] = std::sin(1.3 * static_cast<double>(i));
    b[i] = std::cos(0.7 * static_cast<double>(i));
  }
  std::vector<double> const la = correlation.correlate(a), ltb = correlation.correlate_transposed(b);
  double left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < 35; ++i) {
    left += la[i] * b[i];
    right += a[i] * ltb[i];
  }
  EXPECT_NEAR(left, right, 1e-12);
}

// A chain of nodes along x with independent vectors, trapezoid, reference at its left end: rho_k = h (g_0/2 + g_1 + ..
// + g_k/2) on paper, in two equal rows (equal gradients along y have no effect by symmetry if sigma_y is huge).
TEST(DensityUncertainty, IsTheSumOfVariancesAlongAChain) {
  GradientMap map;
  map.grid = {6, 2, {}, {0.5, 0.5}};
  map.valid.assign(12, 1);
  map.gradient.assign(12, {});
  map.sigma.assign(12, {0.2, 1e6});
  IntegrationSettings settings;
  settings.rule = EdgeRule::trapezoid;
  DensityIntegrator const integrator(map, zero_left_side(map.grid), settings);
  DensityUncertainty const result = propagate_uncertainty(integrator, map.sigma, {}, 0.03);
  EXPECT_EQ(result.samples, 0u);
  for (int k = 0; k < 6; ++k) {
    double const variance = k == 0 ? 0.0 : 0.25 * 0.04 * (k - 1 + 0.5);
    EXPECT_NEAR(result.sigma[map.grid.index(k, 1)], std::sqrt(variance + 0.03 * 0.03), 1e-6);
  }
}

// 68 % of errors with the assumed covariance are within sigma, also for windows that overlap by 75 %. Within one field
// the errors are correlated, so the fraction is averaged over at least 30 fields. A sigma that neglects the correlation
// covers too few errors.
TEST(DensityUncertainty, CoversTheErrorsOfCorrelatedNoise) {
  int const n = 25;
  GradientMap const clean = noisy_map(n);
  for (double overlap : {0.0, 0.5, 0.75}) {
    WindowOverlap const windows = WindowOverlap::from_fraction(overlap);
    WindowCorrelation const correlation(n, n, windows);
    for (std::string const method : {"wls", "poisson"}) {
      DensityIntegrator const integrator(clean, zero_left_side(clean.grid), {method});
      DensityUncertainty const result = propagate_uncertainty(integrator, clean.sigma, windows);
      DensityUncertainty const independent = propagate_uncertainty(integrator, clean.sigma, {});
      std::vector<double> const truth = integrator.integrate(clean.gradient);
      std::uint64_t const fields = method == "poisson" ? 300 : 30;
      double within = 0.0, within_independent = 0.0, count = 0.0;
      for (std::uint64_t seed = 1; seed <= fields; ++seed) {
        std::vector<double> const density = integrator.integrate(with_noise(clean, correlation, seed).gradient);
        for (std::size_t i = 0; i < density.size(); ++i) {
          if (integrator.reference_nodes()[i] != 0) continue;
          count += 1.0;
          within += std::abs(density[i] - truth[i]) <= result.sigma[i];
          within_independent += std::abs(density[i] - truth[i]) <= independent.sigma[i];
        }
      }
      EXPECT_GT(within / count, 0.60);
      EXPECT_LT(within / count, 0.76);
      if (overlap > 0.6) {
        EXPECT_LT(within_independent / count, 0.45);
      }
    }
  }
}

// Coverage of noise that is generated without WindowCorrelation: each vector's error is the mean of white pixel noise
// over its window of 4 x 4 cells, one cell being the distance between vectors (75 % overlap).
TEST(DensityUncertainty, CoversTheErrorsOfPixelNoiseInTheWindows) {
  int const n = 25, cells = 4;
  GradientMap const map = noisy_map(n);
  DensityIntegrator const integrator(map, zero_left_side(map.grid));
  DensityUncertainty const result = propagate_uncertainty(integrator, map.sigma, WindowOverlap::from_fraction(0.75));
  double within = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    KeyedEngine engine(seed, RandomStream::noise_reference, 11);
    int const pixels = n + cells - 1;
    std::vector<Vec2d> pixel(static_cast<std::size_t>(pixels * pixels));
    for (Vec2d& value : pixel) value = {normal_variate(engine), normal_variate(engine)};
    std::vector<Vec2d> error(map.grid.size());
    for (int row = 0; row < n; ++row)
      for (int column = 0; column < n; ++column) {
        Vec2d mean{};
        for (int j = 0; j < cells; ++j)
          for (int i = 0; i < cells; ++i)
            mean += pixel[static_cast<std::size_t>((row + j) * pixels + column + i)] / cells;  // of unit variance
        Vec2d const sigma = map.sigma[map.grid.index(column, row)];
        error[map.grid.index(column, row)] = {sigma.x * mean.x, sigma.y * mean.y};
      }
    std::vector<double> const density_error = integrator.integrate_error(error);
    for (std::size_t i = 0; i < density_error.size(); ++i) {
      if (integrator.reference_nodes()[i] != 0) continue;
      count += 1.0;
      within += std::abs(density_error[i]) <= result.sigma[i];
    }
  }
  RecordProperty("coverage", std::to_string(within / count));
  EXPECT_GT(within / count, 0.60);
  EXPECT_LT(within / count, 0.76);
}

// Noise varies over the field by a factor of 11: the weights keep the noisy band out.
TEST(DensityUncertainty, IsReducedByTheWeights) {
  int const n = 49;
  GradientMap const clean = noisy_map(n);
  WindowOverlap const windows = WindowOverlap::from_fraction(0.5);
  WindowCorrelation const correlation(n, n, windows);
  DensityIntegrator const weighted(clean, zero_left_side(clean.grid));
  DensityIntegrator const poisson(clean, zero_left_side(clean.grid), {"poisson"});
  double weighted_sum = 0.0, poisson_sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    std::vector<Vec2d> const noise = draw_gradient_error(correlation, clean.sigma, seed, 7);
    for (double e : weighted.integrate_error(noise)) weighted_sum += e * e;
    for (double e : poisson.integrate_error(noise)) poisson_sum += e * e;
  }
  EXPECT_LT(std::sqrt(weighted_sum / poisson_sum), 0.7);
}

// With K samples sigma has a relative standard error of 1/sqrt(2 K): 5 % for 200.
TEST(DensityUncertainty, AgreesBetweenExactAndSampled) {
  int const n = 25;
  GradientMap const map = noisy_map(n);
  WindowOverlap const windows = WindowOverlap::from_fraction(0.6);
  DensityIntegrator const integrator(map, zero_left_side(map.grid));
  DensityUncertainty const exact = propagate_uncertainty(integrator, map.sigma, windows);
  PropagationSettings settings;
  settings.exact_limit = 0;
  settings.samples = 200;
  DensityUncertainty const sampled = propagate_uncertainty(integrator, map.sigma, windows, 0.0, settings);
  EXPECT_NEAR(sampled.relative_error, 0.05, 1e-12);
  double square = 0.0, count = 0.0;
  for (std::size_t i = 0; i < exact.sigma.size(); ++i) {
    if (integrator.reference_nodes()[i] != 0) continue;
    double const relative = sampled.sigma[i] / exact.sigma[i] - 1.0;
    square += relative * relative;
    count += 1.0;
  }
  EXPECT_LT(std::sqrt(square / count), 2.0 * sampled.relative_error);
  EXPECT_GT(std::sqrt(square / count), 0.3 * sampled.relative_error);
}

// 2 % of 0.5 above the reference and a random part of 0.024 give 0.026.
TEST(DensityUncertainty, AddsTheScaleInQuadrature) {
  std::vector<double> const density{1.7, 1.2};
  std::vector<double> const sigma = add_scale_uncertainty({0.024, 0.024}, density, 1.2, 0.02);
  EXPECT_NEAR(sigma[0], 0.026, 1e-12);
  EXPECT_NEAR(sigma[1], 0.024, 1e-12);
}

TEST(DensityUncertainty, RejectsBadInput) {
  GradientMap const map = noisy_map(9);
  DensityIntegrator const integrator(map, zero_left_side(map.grid));
  EXPECT_THAT([&] { propagate_uncertainty(integrator, {}, {}); },
              ThrowsDataError(ErrorCode::missing_content, "density gradient"));
  EXPECT_THROW(propagate_uncertainty(integrator, map.sigma, {20.0, 2.0}), SetupError);
  EXPECT_THROW(propagate_uncertainty(integrator, map.sigma, {2.0, std::nan("")}), SetupError);
  EXPECT_THROW(WindowOverlap::from_fraction(1.0), SetupError);
  PropagationSettings no_samples;
  no_samples.samples = 0;
  EXPECT_THROW(propagate_uncertainty(integrator, map.sigma, {}, 0.0, no_samples), SetupError);
}

}  // namespace
}  // namespace gladstone::inline density
