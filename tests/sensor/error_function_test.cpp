#include "render/sensor/error_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gladstone {
namespace {

template <class T, int N>
Lanes<T, N> erf_of(Lanes<T, N> x) {
  Lanes<T, N> rows[1] = {x};
  error_function(rows);
  return rows[0];
}
double erf_of(double x) { return erf_of(Lanes<double, 4>::all(x)).v[0]; }

// The remainder of the polynomial is below 9e-13 on [0, 5]. Beyond, the result is erf(5) = 1 - 1.54e-12, which differs
// from the exact value by at most 1.6e-12.
TEST(ErrorFunction, AgreesWithTheStandardLibrary) {
  for (int i = -8000; i <= 8000; ++i) {
    double const x = i * 1e-3;
    ASSERT_NEAR(erf_of(x), std::erf(x), std::abs(x) < 4.8 ? 1e-12 : 2.5e-12) << x;
  }
}

TEST(ErrorFunction, IsOddAndSaturates) {
  EXPECT_EQ(erf_of(0), 0);
  for (double const x : {1e-9, 0.3, 1.0, 2.7, 4.999, 7.0}) EXPECT_EQ(erf_of(-x), -erf_of(x));
  EXPECT_EQ(erf_of(5), erf_of(std::numeric_limits<double>::max()));
}

// The four lanes of a register give the same results as the plain loop of other widths and scalar types.
TEST(ErrorFunction, IsTheSameInEveryWidth) {
  double const x[4] = {-3.1, -0.2, 0.7, 4.2};
  Lanes<double, 4> const four = erf_of(Lanes<double, 4>::load(x));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(four.v[i], erf_of(Lanes<double, 1>::all(x[i])).v[0], 4e-16);
    // in single precision, the rounding of 27 terms below 0.29 amounts to a few units of 6e-8
    EXPECT_NEAR(four.v[i], static_cast<double>(erf_of(Lanes<float, 4>::all(static_cast<float>(x[i]))).v[0]), 1e-6);
  }
}

}  // namespace
}  // namespace gladstone
