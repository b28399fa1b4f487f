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

// The polynomial's remainder is below 9e-13 on [0, 5]; beyond, it stays at erf(5) = 1 - 1.54e-12, 1.6e-12 from one at
// most.
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

// The four lanes of a register and the plain loop of other widths and scalars are the same function.
TEST(ErrorFunction, IsTheSameInEveryWidth) {
  double const x[4] = {-3.1, -0.2, 0.7, 4.2};
  Lanes<double, 4> const four = erf_of(Lanes<double, 4>::load(x));
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(four.v[i], erf_of(Lanes<double, 1>::all(x[i])).v[0], 4e-16);
    // in single precision 27 terms below 0.29 round to a few units of 6e-8
    EXPECT_NEAR(four.v[i], static_cast<double>(erf_of(Lanes<float, 4>::all(static_cast<float>(x[i]))).v[0]), 1e-6);
  }
}

}  // namespace
}  // namespace gladstone
