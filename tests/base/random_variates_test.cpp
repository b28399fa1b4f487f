#include "render/base/random_variates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/poisson_variate.h"

namespace gladstone {
namespace {

constexpr int draws = 200000;

KeyedEngine engine_of(int item) { return {11, RandomStream::noise_flow, static_cast<std::uint64_t>(item)}; }

// Compares ln k! with ln Gamma(k + 1) of the standard library.
TEST(LogFactorial, IsThatOfTheGammaFunction) {
  for (double const k : {0.0, 1.0, 2.0, 6.0, 7.0, 8.0, 20.0, 170.0, 1e5, 1e9}) {
    EXPECT_NEAR(log_factorial(k), std::lgamma(k + 1), 1e-9 + 1e-14 * std::lgamma(k + 1)) << k;
  }
}

// All probabilities of a Poisson distribution, P(k) = m^k e^-m / k!, for means on both sides of the change of method.
// The count of k among n draws has the variance n P (1 - P). The tolerance is five standard deviations, for all k with
// an expected count of at least ten.
TEST(PoissonVariate, HasEveryShareOfItsDistribution) {
  for (double const mean : {0.05, 1.0, 3.7, 9.99, 10.0, 31.0, 400.0}) {
    std::map<double, int> counts;
    for (int i = 0; i < draws; ++i) {
      KeyedEngine engine = engine_of(i);
      counts[poisson_variate(engine, mean)]++;
    }
    for (double k = 0; k < 3 * mean + 20; ++k) {
      double const share = std::exp(k * std::log(mean) - mean - std::lgamma(k + 1)), expected = draws * share;
      if (expected < 10) continue;
      EXPECT_NEAR(counts[k], expected, 5 * std::sqrt(expected * (1 - share))) << k << " of mean " << mean;
    }
  }
}

// Mean and variance of a Poisson distribution both equal m; the sample variance of n draws has the standard deviation m
// sqrt((2 + 1/m)/n). The tolerance is five standard deviations.
TEST(PoissonVariate, HasTheMomentsOfLargeMeans) {
  for (double const mean : {1e3, 1e6, 1e11}) {
    double sum = 0, square = 0;
    for (int i = 0; i < draws; ++i) {
      KeyedEngine engine = engine_of(i);
      double const off = poisson_variate(engine, mean) - mean;
      sum += off / draws;
      square += off * off / draws;
    }
    EXPECT_NEAR(sum, 0, 5 * std::sqrt(mean / draws)) << mean;
    EXPECT_NEAR(square / mean, 1, 5 * std::sqrt(2.0 / draws)) << mean;
  }
}

// Probabilities of intervals from the error function, with the same tolerance as above.
TEST(NormalVariate, HasEveryShareOfItsDistribution) {
  std::map<int, int> counts;
  for (int i = 0; i < draws; ++i) {
    KeyedEngine engine = engine_of(i);
    counts[static_cast<int>(std::floor(2 * normal_variate(engine)))]++;
  }
  for (int bin = -7; bin < 7; ++bin) {
    auto const below = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
    double const share = below(0.5 * (bin + 1)) - below(0.5 * bin), expected = draws * share;
    EXPECT_NEAR(counts[bin], expected, 5 * std::sqrt(expected * (1 - share))) << bin;
  }
}

}  // namespace
}  // namespace gladstone
