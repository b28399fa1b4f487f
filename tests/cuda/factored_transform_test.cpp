#include "cuda/correlation/factored_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <random>
#include <vector>

#include "render/base/units.h"

namespace gladstone::cuda {
namespace {

/// Computes sum over n of z(n) exp(sign 2 pi i k n / size) by its definition.
template <int radix, int sign>
void expect_small_transform() {
  std::mt19937 random(radix);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  Complex z[radix];
  std::complex<double> given[radix];
  for (int n = 0; n < radix; ++n) {
    z[n] = {value(random), value(random)};
    given[n] = {z[n].re, z[n].im};
  }
  small_transform<radix, sign, 1>(z);
  for (int k = 0; k < radix; ++k) {
    std::complex<double> sum = 0.0;
    for (int n = 0; n < radix; ++n) sum += given[n] * std::polar(1.0, sign * 2.0 * pi * k * n / radix);
    EXPECT_NEAR(z[k].re, sum.real(), 4e-6) << radix << ", " << k;
    EXPECT_NEAR(z[k].im, sum.imag(), 4e-6) << radix << ", " << k;
  }
}

template <int... radices>
void expect_small_transforms() {
  (expect_small_transform<radices, 1>(), ...);
  (expect_small_transform<radices, -1>(), ...);
}

TEST(SmallTransform, IsTheSumThatDefinesIt) { expect_small_transforms<2, 3, 4, 5, 6, 8, 12, 16>(); }

/// Executes the threads of a block one after the other, in ascending or descending order: if threads exchanged values
/// without a barrier in between, the results of the two orders would differ.
template <class Transform>
std::vector<float> plane_by_threads(std::vector<float> const& a, std::vector<float> const& b, int side, int radius,
                                    bool falling) {
  float const nothing = std::numeric_limits<float>::quiet_NaN();
  std::vector<Complex> memory(static_cast<std::size_t>(Transform::values(radius)), {nothing, nothing});
  std::vector<Complex> roots;
  for (int k = 0; k < Transform::size; ++k) {
    double const angle = -2.0 * pi * k / Transform::size;
    roots.push_back({static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))});
  }
  auto const threads_do = [&](auto const& step) {
    for (int k = 0; k < Transform::threads; ++k)
      step(Transform{memory.data(), roots.data(), falling ? Transform::threads - 1 - k : k});
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      auto const at = static_cast<std::size_t>(y * side + x);
      memory[static_cast<std::size_t>(y * Transform::pitch + x)] = {a[at], b[at]};
    }
  threads_do([&](Transform const& t) { t.column_first_pass(side, [](Complex z, int) { return z; }); });
  threads_do([&](Transform const& t) { t.column_second_pass(side); });
  threads_do([&](Transform const& t) { t.row_first_pass(side); });
  threads_do([&](Transform const& t) { t.row_second_pass(); });
  threads_do([&](Transform const& t) { t.product(WholeSpectrum()); });
  threads_do([&](Transform const& t) { t.inverse_column_second_pass(); });
  threads_do([&](Transform const& t) { t.inverse_row_first_pass(radius); });
  threads_do([&](Transform const& t) { t.inverse_row_second_pass(radius); });
  float const* const centre = Transform{memory.data(), roots.data(), 0}.centre(radius);
  std::vector<float> plane;
  for (int dy = -radius - 1; dy <= radius + 1; ++dy)
    for (int dx = -radius - 1; dx <= radius + 1; ++dx)
      plane.push_back(centre[dy * Transform::plane_pitch + dx] / (Transform::size * Transform::size));
  return plane;
}

/// Compares with the sum over the window's pixels, with shifts modulo the transform's size.
template <class Transform>
void expect_correlation(int side, int radius) {
  int const size = Transform::size;
  std::mt19937 random(static_cast<unsigned>(size + side));
  std::normal_distribution<float> grey;
  std::vector<float> a(static_cast<std::size_t>(side * side)), b = a;
  for (float& value : a) value = grey(random);
  for (float& value : b) value = grey(random);
  std::vector<float> const plane = plane_by_threads<Transform>(a, b, side, radius, false);
  EXPECT_EQ(plane, plane_by_threads<Transform>(a, b, side, radius, true));
  std::size_t at = 0;
  for (int dy = -radius - 1; dy <= radius + 1; ++dy)
    for (int dx = -radius - 1; dx <= radius + 1; ++dx, ++at) {
      double sum = 0.0;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          int const to_x = (x + dx + size) % size, to_y = (y + dy + size) % size;
          if (to_x < side && to_y < side)
            sum += static_cast<double>(a[static_cast<std::size_t>(y * side + x)]) *
                   b[static_cast<std::size_t>(to_y * side + to_x)];
        }
      // `size` values of order 1 with float's relative error of 6e-8 of their root sum of squares, in about twenty
      // steps
      ASSERT_NEAR(plane[at], sum, 2e-6 * side) << dx << ", " << dy;
    }
}

TEST(FactoredTransform, GivesTheCorrelationOfGaussianWindows) {
  expect_correlation<FactoredTransform<8, 4, 128>>(32, 4);
  expect_correlation<FactoredTransform<8, 5, 160>>(40, 5);
  expect_correlation<FactoredTransform<8, 6, 96>>(48, 12);
  expect_correlation<FactoredTransform<8, 8, 256>>(64, 16);
  expect_correlation<FactoredTransform<12, 8, 576>>(96, 12);
  expect_correlation<FactoredTransform<16, 8, 1024>>(128, 32);
}

TEST(FactoredTransform, GivesTheCorrelationOfUniformWindows) {
  expect_correlation<FactoredTransform<8, 6, 96>>(32, 16);
  expect_correlation<FactoredTransform<12, 8, 576>>(64, 32);
  expect_correlation<FactoredTransform<8, 5, 160>>(24, 12);
}

}  // namespace
}  // namespace gladstone::cuda
