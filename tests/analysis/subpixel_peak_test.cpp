#include "analysis/subpixel_peak.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/peak_search.h"

namespace gladstone {
namespace {

// The logarithm of a Gaussian is a parabola, whose vertex three points give exactly.
TEST(GaussianPeak, IsExactForAGaussian) {
  for (double const sigma : {0.5, 1.0, 2.5})
    for (double shift = -0.5; shift <= 0.5; shift += 0.0625) {
      auto const value = [&](double s) { return 3.0 * std::exp(-0.5 * (s - shift) * (s - shift) / (sigma * sigma)); };
      EXPECT_NEAR(gaussian_peak(value(-1.0), value(0.0), value(1.0)).offset, shift, 1e-14);
    }
}

TEST(GaussianPeak, FallsBackToTheParabolaWhereALogarithmIsMissing) {
  EXPECT_DOUBLE_EQ(gaussian_peak(-0.5, 1.0, 0.5).offset, parabola_offset(-0.5, 1.0, 0.5));
  EXPECT_DOUBLE_EQ(parabola_offset(-0.5, 1.0, 0.5), 0.25);
  EXPECT_DOUBLE_EQ(gaussian_peak(0.0, 1.0, 0.0).offset, 0.0);
}

TEST(GaussianPeak, StaysFiniteOnAFlatTop) {
  EXPECT_EQ(gaussian_peak(1.0, 1.0, 1.0).offset, 0.0);
  EXPECT_EQ(gaussian_peak(1e-30, 1e-30, 1.0).offset, 0.0) << "curved upwards: no peak";
}

class Plane {
 public:
  void set(int dx, int dy, float value) {
    values_[static_cast<std::size_t>(((dy + size) % size) * size + (dx + size) % size)] = value;
  }
  PlaneView<float> view() const { return {values_.data(), size, 1}; }

 private:
  static constexpr int size = 32;
  std::vector<float> values_ = std::vector<float>(size * size, -1.0f);
};

TEST(PeakSearch, OrdersPeaksByHeightAcrossTheWrap) {
  Plane plane;
  plane.set(-3, 4, 0.4f);
  plane.set(5, -6, 0.9f);
  plane.set(0, 0, 0.6f);
  plane.set(-7, -7, 0.2f);
  PeakList<float> const found = find_peaks(plane.view(), 8);
  ASSERT_EQ(found.count, 3);
  EXPECT_EQ(found.peak[0].x, 5);
  EXPECT_EQ(found.peak[0].y, -6);
  EXPECT_EQ(found.peak[1].height, 0.6f);
  EXPECT_EQ(found.peak[2].height, 0.4f);
}

// A Gaussian of 1 px half a pixel off its samples shows 88 % of its height; another of 95 % of its height, on a sample,
// is the lower one all the same, and is not as near to nothing.
TEST(PeakSearch, RanksPeaksByTheirHeightBetweenSamples) {
  Plane plane;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) {
      auto const peak = [&](double at) { return std::exp(-0.5 * ((x - at) * (x - at) + y * y)); };
      plane.set(x, y, static_cast<float>(0.95 * peak(-7.0) + peak(0.5)));
    }
  PeakList<float> const found = find_peaks(plane.view(), 9);
  ASSERT_EQ(found.count, 2);
  EXPECT_EQ(found.peak[0].x, 0);
  EXPECT_NEAR(found.peak[0].height, 1.0, 1e-5);
  EXPECT_NEAR(found.peak[1].height, 0.95, 1e-5);
}

TEST(PeakSearch, CountsARaggedPeakOnce) {
  Plane plane;
  plane.set(0, 0, 0.5f);  // three maxima within two pixels
  plane.set(2, 0, 0.8f);
  plane.set(2, 2, 0.6f);
  plane.set(-5, 0, 0.3f);
  PeakList<float> const found = find_peaks(plane.view(), 8);
  ASSERT_EQ(found.count, 2);
  EXPECT_EQ(found.peak[0].height, 0.8f);
  EXPECT_EQ(found.peak[1].height, 0.3f);
}

TEST(PeakSearch, LeavesOutMaximaBeyondTheRadiusAndSlopesTowardsThem) {
  Plane plane;
  plane.set(5, 0, 0.9f);
  plane.set(4, 0, 0.5f);
  EXPECT_EQ(find_peaks(plane.view(), 4).count, 0);
  EXPECT_EQ(find_peaks(plane.view(), 5).count, 1);
}

}  // namespace
}  // namespace gladstone
