#include "analysis/vectors/sequence_statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

/// Field on a row of points.
DisplacementField row_of(std::vector<Vec2d> const& displacements) {
  DisplacementField field;
  field.displacement_px = displacements;
  for (std::size_t i = 0; i < displacements.size(); ++i)
    field.position_px.push_back({16.0 * static_cast<double>(i), 8});
  field.status.assign(displacements.size(), VectorStatus::valid);
  field.reason.assign(displacements.size(), VectorReason::measured);
  field.columns = static_cast<int>(displacements.size());
  field.rows = 1;
  return field;
}

/// Fraction of points at which |estimate - exact| is at most two standard errors, for u, and mean fraction of
/// independent samples.
struct Coverage {
  double mean = 0, uu = 0, uv = 0, rms = 0, independent = 0;
};

/// Simulates Gaussian series u(t) = c u(t - 1) + noise, v = (u + w)/2 with an independent w of the same kind, all of
/// unit variance before the mean (5, -3) is added: uu = 1, vv = 1/2, uv = 1/2.
Coverage simulate(double c, std::size_t points, std::size_t samples) {
  std::mt19937_64 bits(7);
  std::normal_distribution<double> normal;
  std::vector<Vec2d> state(points);
  for (Vec2d& s : state) s = {normal(bits), normal(bits)};
  SequenceStatistics statistics;
  for (std::size_t t = 0; t < samples; ++t) {
    std::vector<Vec2d> d(points);
    for (std::size_t i = 0; i < points; ++i) {
      double const rest = std::sqrt(1 - c * c);
      state[i] = c * state[i] + rest * Vec2d{normal(bits), normal(bits)};
      d[i] = {5 + state[i].x, -3 + 0.5 * (state[i].x + state[i].y)};
    }
    statistics.add(row_of(d));
  }
  SequenceMoments const m = statistics.moments();
  Coverage coverage;
  auto const n = static_cast<double>(points);
  for (std::size_t i = 0; i < points; ++i) {
    coverage.mean += (std::abs(m.mean_px[i].x - 5) <= 2 * m.mean_error_px[i].x) / n;
    coverage.uu += (std::abs(m.stress_px2[i].uu - 1) <= 2 * m.stress_error[i].uu) / n;
    coverage.uv += (std::abs(m.stress_px2[i].uv - 0.5) <= 2 * m.stress_error[i].uv) / n;
    coverage.rms += (std::abs(m.rms_px[i].x - 1) <= 2 * m.rms_error_px[i].x) / n;
    coverage.independent += m.independent[i].x / static_cast<double>(samples) / n;
  }
  return coverage;
}

// White noise: all samples are independent, and two standard errors cover 95.4 % of a normal distribution. The
// coverage over 2000 points scatters by 0.5 %. The sum over positive autocorrelations of finite samples is positive on
// average, so that standard errors are somewhat too large: about sqrt(2/(pi n)) per lag in the sum.
TEST(SequenceStatistics, CoverTheTruthOfWhiteNoise) {
  Coverage const coverage = simulate(0.0, 2000, 400);
  EXPECT_NEAR(coverage.mean, 0.96, 0.02);
  EXPECT_NEAR(coverage.uu, 0.95, 0.02);
  EXPECT_NEAR(coverage.uv, 0.95, 0.02);
  EXPECT_NEAR(coverage.rms, 0.95, 0.02);
  EXPECT_GT(coverage.independent, 0.85);
  EXPECT_LE(coverage.independent, 1.0);
}

// A first-order autoregressive series with coefficient c has rho_k = c^k, hence (1 - c)/(1 + c) independent samples per
// sample: 1/3 for c = 1/2. Without it, two standard errors would cover only 75 %.
TEST(SequenceStatistics, CoverTheTruthOfCorrelatedSeries) {
  Coverage const coverage = simulate(0.5, 2000, 600);
  EXPECT_NEAR(coverage.mean, 0.95, 0.025);
  EXPECT_NEAR(coverage.uu, 0.95, 0.025);
  EXPECT_NEAR(coverage.uv, 0.95, 0.025);
  EXPECT_NEAR(coverage.independent, 1.0 / 3.0, 0.03);
}

/// Velocity of homogeneous turbulence at one point: the sum of Fourier modes of random phase and direction with the
/// frequencies of a Gaussian spectrum, so that its autocorrelation is exp(-(s k)^2/2). Normalised to unit variance.
class TurbulentVelocity {
 public:
  static constexpr std::size_t modes = 64;
  static constexpr double spectrum_width = 0.6;  ///< s, standard deviation of the frequencies [rad/sample]

  explicit TurbulentVelocity(std::mt19937_64& bits) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (std::size_t n = 0; n < modes; ++n) {
      state_[n] = std::polar(std::sqrt(2.0 / modes), phase(bits));
      turn_[n] = std::polar(1.0, spectrum_width * normal(bits));
    }
  }
  double next() {
    double sum = 0;
    for (std::size_t n = 0; n < modes; ++n) sum += (state_[n] *= turn_[n]).real();
    return sum;
  }

 private:
  std::array<std::complex<double>, modes> state_, turn_;
};

// A turbulent shear flow with the Reynolds stresses of a log layer: u = 6 + 2 a, v = -0.5 - 0.4 a + 0.8 b with
// independent a and b of unit variance, so that uu = 4, vv = 0.16 + 0.64 = 0.8, uv = -0.8 (a correlation of -0.45).
// - Two standard errors contain the truth in 95.4 % of all cases. 1500 points scatter by 0.55 %; the errors are
// estimated
//   from N independent samples, which scatter by about 10 %: 0.95 within 0.025.
// - rho_k = exp(-0.18 k^2), whose sum is sqrt(pi/0.72) - 1/2 = 1.59, so that N = n/4.18. With N = n the errors would be
//   half as large and contain the truth in 67 % of a normal distribution, in somewhat more of the means here, which few
//   modes of low frequency determine.
// - The variance contains sum rho_k^2 = sqrt(pi/1.44) - 1/2 = 0.98 (N = n/2.95).
TEST(SequenceStatistics, CoverTheTruthOfTurbulence) {
  constexpr std::size_t points = 1500, samples = 400;
  std::mt19937_64 bits(11);
  std::vector<TurbulentVelocity> a, b;
  for (std::size_t i = 0; i < points; ++i) {
    a.emplace_back(bits);
    b.emplace_back(bits);
  }
  SequenceStatistics statistics;
  for (std::size_t t = 0; t < samples; ++t) {
    std::vector<Vec2d> d(points);
    for (std::size_t i = 0; i < points; ++i) {
      double const first = a[i].next(), second = b[i].next();
      d[i] = {6 + 2 * first, -0.5 - 0.4 * first + 0.8 * second};
    }
    statistics.add(row_of(d));
  }
  SequenceMoments const m = statistics.moments();
  std::map<std::string, double> covered;
  double independent = 0, naive = 0;
  for (std::size_t i = 0; i < points; ++i) {
    auto const count = [&covered](char const* name, double error, double standard_error) {
      covered[name] += (std::abs(error) <= 2 * standard_error) / static_cast<double>(points);
    };
    count("mean of u", m.mean_px[i].x - 6, m.mean_error_px[i].x);
    count("mean of v", m.mean_px[i].y + 0.5, m.mean_error_px[i].y);
    count("uu", m.stress_px2[i].uu - 4, m.stress_error[i].uu);
    count("vv", m.stress_px2[i].vv - 0.8, m.stress_error[i].vv);
    count("uv", m.stress_px2[i].uv + 0.8, m.stress_error[i].uv);
    independent += m.independent[i].x / static_cast<double>(samples * points);
    naive += (std::abs(m.mean_px[i].x - 6) <= 2 * m.rms_px[i].x / std::sqrt(samples)) / static_cast<double>(points);
  }
  for (auto const& [name, fraction] : covered) EXPECT_NEAR(fraction, 0.95, 0.025) << name;
  EXPECT_NEAR(independent, 1 / 4.18, 0.02);
  EXPECT_LT(naive, 0.8);
}

// Moments computed by their definitions from a short series with a missing vector, an interpolated one, a replacement
// by a secondary peak (which is a measurement), and a missing field.
TEST(SequenceStatistics, AreThoseOfMeasuredVectors) {
  std::vector<Vec2d> const series{{1, -2}, {1.25, -1}, {9, 9}, {0.5, -2.5}, {3, -1.5}, {7, 7}, {2, -3}};
  SequenceStatistics statistics(3);
  std::vector<Vec2d> used;
  for (std::size_t t = 0; t < series.size(); ++t) {
    DisplacementField field = row_of({series[t], {4.125, 0.5}});
    if (t == 2) {
      field.status[0] = VectorStatus::replaced;
      field.reason[0] = VectorReason::neighbours;
    } else if (t == 3) {
      field.status[0] = VectorStatus::replaced;
      field.reason[0] = VectorReason::other_peak;
    } else if (t == 5) {
      field.status[0] = VectorStatus::invalid;
      field.displacement_px[0] = {not_a_number, not_a_number};
    }
    if (t == 4) statistics.skip();
    statistics.add(field);
    if (t != 2 && t != 5) used.push_back(series[t]);
  }
  SequenceMoments const m = statistics.moments();
  double const n = static_cast<double>(used.size());
  Vec2d mean;
  for (Vec2d const& d : used) mean += (1 / n) * d;
  double uu = 0, uv = 0;
  for (Vec2d const& d : used) {
    double const a = d.x - mean.x, b = d.y - mean.y;
    uu += a * a;
    uv += a * b;
  }
  EXPECT_EQ(m.samples, 8u);
  EXPECT_EQ(m.lags, 3u);
  EXPECT_EQ(m.count[0], 5);
  EXPECT_NEAR(m.mean_px[0].x, mean.x, 1e-14);
  EXPECT_NEAR(m.mean_px[0].y, mean.y, 1e-14);
  EXPECT_NEAR(m.stress_px2[0].uu, uu / (n - 1), 1e-13);
  EXPECT_NEAR(m.stress_px2[0].uv, uv / (n - 1), 1e-13);
  EXPECT_NEAR(m.rms_px[0].x, std::sqrt(uu / (n - 1)), 1e-13);
  // Known times are 0, 1, 3, 5, 7. The autocorrelation is positive at lag 1 (0 and 1) and negative at lag 2.
  double const rho = (series[1].x - mean.x) * (series[0].x - mean.x) / (uu / n);
  ASSERT_GT(rho, 0);
  double const independent = n / (1 + 2 * (1 - 1 / n) * rho);
  EXPECT_NEAR(m.independent[0].x, independent, 1e-12);
  EXPECT_NEAR(m.mean_error_px[0].x, std::sqrt(uu / n / (independent - 1)), 1e-13);
  EXPECT_GT(m.stress_error[0].uv, 0);

  // A constant displacement has no variance, exactly.
  EXPECT_EQ(m.count[1], 7);
  EXPECT_EQ(m.mean_px[1], (Vec2d{4.125, 0.5}));
  EXPECT_EQ(m.rms_px[1], (Vec2d{0, 0}));
  EXPECT_EQ(m.mean_error_px[1], (Vec2d{0, 0}));
}

TEST(SequenceStatistics, DoNotDependOnTheNumberOfThreads) {
  std::vector<std::vector<double>> results;
  for (int const threads : {1, 3}) {
    set_thread_count(threads);
    std::mt19937_64 bits(3);
    std::normal_distribution<double> normal;
    SequenceStatistics statistics;
    for (int t = 0; t < 40; ++t) {
      std::vector<Vec2d> d(3000);
      for (Vec2d& one : d) one = {normal(bits), normal(bits)};
      statistics.add(row_of(d));
    }
    SequenceMoments const m = statistics.moments();
    std::vector<double> all;
    for (std::size_t i = 0; i < 3000; ++i)
      for (double const value : {m.mean_px[i].x, m.stress_px2[i].uv, m.stress_error[i].vv, m.independent[i].y})
        all.push_back(value);
    results.push_back(std::move(all));
  }
  set_thread_count(0);
  EXPECT_EQ(results[0], results[1]);
}

// A point with one vector has a mean but no standard error; one without vectors has nothing.
TEST(SequenceStatistics, AreUnknownWithoutVectors) {
  SequenceStatistics statistics;
  DisplacementField field = row_of({{1, 2}, {3, 4}});
  field.status[1] = VectorStatus::masked;
  statistics.add(field);
  SequenceMoments const m = statistics.moments();
  EXPECT_EQ(m.mean_px[0], (Vec2d{1, 2}));
  EXPECT_TRUE(std::isnan(m.mean_error_px[0].x) && std::isnan(m.rms_px[0].x));
  EXPECT_EQ(m.count[1], 0);
  EXPECT_TRUE(std::isnan(m.mean_px[1].x));
}

}  // namespace
}  // namespace gladstone
