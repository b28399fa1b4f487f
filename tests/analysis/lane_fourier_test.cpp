#include "analysis/correlation/lane_fourier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "render/base/units.h"

namespace gladstone {
namespace {

/// Eight different sequences of numbers between -1 and 1.
std::vector<ComplexLanes> random_lines(int count) {
  std::mt19937 bits(7);
  auto const number = [&] { return static_cast<float>(bits()) * 0x1p-31f - 1.0f; };
  std::vector<ComplexLanes> lines(static_cast<std::size_t>(count));
  for (ComplexLanes& value : lines)
    for (int lane = 0; lane < lane_count; ++lane) {
      value.re[lane] = number();
      value.im[lane] = number();
    }
  return lines;
}

std::complex<double> lane_of(ComplexLanes const& value, int lane) { return {value.re[lane], value.im[lane]}; }

// The definition, summed in double precision. Float has a relative error of 6e-8 in each of about log2(n) partial
// results, whose rms is sqrt(2 n/3): 8 times that for the worst of n values in eight lanes.
TEST(LaneFourier, IsTheSumOfItsDefinition) {
  for (int const size : {4, 8, 12, 16, 20, 24, 32, 40, 48, 60, 64, 96, 100, 128, 144, 160, 256}) {
    LaneFourier const fourier(size);
    std::vector<ComplexLanes> const in = random_lines(size * LaneFourier::pitch(size));
    std::vector<ComplexLanes> out(static_cast<std::size_t>(size));
    std::vector<ComplexLanes> scratch(static_cast<std::size_t>(fourier.scratch()));
    double const tolerance = 8.0 * 6e-8 * std::log2(size) * std::sqrt(2.0 * size / 3.0);
    auto const check = [&](int stride, int filled, double sign) {
      for (int k = 0; k < size; ++k)
        for (int lane = 0; lane < lane_count; ++lane) {
          std::complex<double> sum;
          for (int x = 0; x < filled; ++x)
            sum += lane_of(in[static_cast<std::size_t>(x) * stride], lane) *
                   std::polar(1.0, sign * 2.0 * pi * k * x / size);
          EXPECT_LT(std::abs(sum - lane_of(out[static_cast<std::size_t>(k)], lane)), tolerance)
              << size << ' ' << stride << ' ' << filled << ' ' << k << ' ' << lane;
        }
    };
    for (int const stride : {1, 3, LaneFourier::pitch(size)})
      for (int const filled : {size, size / 2, size / 4 + 1}) {
        fourier.forward(in.data(), stride, filled, out.data(), scratch.data());
        check(stride, filled, -1.0);
      }
    fourier.inverse(in.data(), out.data(), scratch.data());
    check(1, size, 1.0);
  }
}

TEST(LaneFourier, TakesTheNextProductOfTwoThreeAndFive) {
  EXPECT_EQ(lane_fourier_size(3), 4);
  EXPECT_EQ(lane_fourier_size(48), 48);
  EXPECT_EQ(lane_fourier_size(49), 60);
  EXPECT_EQ(lane_fourier_size(97), 100);
}

}  // namespace
}  // namespace gladstone
