#include "analysis/correlation/subpixel_peak.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "analysis/correlation/peak_search.h"
#include "render/base/vec.h"

namespace gladstone {
namespace {

// The logarithm of a Gaussian is a parabola, whose vertex follows exactly from three points: its position, and its
// height relative to the middle sample, exp(shift^2 / (2 sigma^2)).
TEST(GaussianPeak, IsExactForAGaussian) {
  for (double const sigma : {0.5, 1.0, 2.5})
    for (double shift = -0.5; shift <= 0.5; shift += 0.0625) {
      auto const value = [&](double s) { return 3.0 * std::exp(-0.5 * (s - shift) * (s - shift) / (sigma * sigma)); };
      auto const peak = gaussian_peak(value(-1.0), value(0.0), value(1.0));
      EXPECT_NEAR(peak.offset, shift, 1e-14);
      EXPECT_NEAR(peak.log_rise, 0.5 * shift * shift / (sigma * sigma), 1e-14);
    }
}

// The parabola through (-1, -0.5), (0, 1), (1, 0.5) is 1 + s/2 - s^2: vertex at 1/4, value 17/16.
TEST(GaussianPeak, FallsBackToTheParabolaWhereALogarithmIsMissing) {
  EXPECT_DOUBLE_EQ(gaussian_peak(-0.5, 1.0, 0.5).offset, 0.25);
  EXPECT_DOUBLE_EQ(gaussian_peak(-0.5, 1.0, 0.5).log_rise, std::log(17.0 / 16.0));
  EXPECT_DOUBLE_EQ(gaussian_peak(-1.5, 3.0, 1.5).offset, 0.25);
  EXPECT_DOUBLE_EQ(gaussian_peak(0.0, 1.0, 0.0).offset, 0.0);
  EXPECT_DOUBLE_EQ(parabola_offset(-0.5, 1.0, 0.5), 0.25);
}

TEST(GaussianPeak, StaysFiniteOnAFlatTop) {
  EXPECT_EQ(gaussian_peak(1.0, 1.0, 1.0).offset, 0.0);
  EXPECT_EQ(gaussian_peak(1.0, 1.0, 1.0).log_rise, 0.0);
  EXPECT_EQ(gaussian_peak(1e-30, 1e-30, 1.0).offset, 0.0) << "curved upwards: no peak";
}

class Plane {
 public:
  explicit Plane(float ground = -1.0f) : values_(size * size, ground) {}
  void set(int dx, int dy, float value) {
    values_[static_cast<std::size_t>(((dy + size) % size) * size + (dx + size) % size)] = value;
  }
  /// A Gaussian of 1 px between the samples.
  void add(Vec2d at, double height) {
    for (int dy = -size / 2; dy < size / 2; ++dy)
      for (int dx = -size / 2; dx < size / 2; ++dx) {
        double const r2 = (dx - at.x) * (dx - at.x) + (dy - at.y) * (dy - at.y);
        values_[static_cast<std::size_t>(((dy + size) % size) * size + (dx + size) % size)] +=
            static_cast<float>(height * std::exp(-0.5 * r2));
      }
  }
  PlaneView<float> view() const { return {values_.data(), size, 1}; }

 private:
  static constexpr int size = 32;
  std::vector<float> values_;
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

// A peak in the middle of four pixels has samples of exp(-1/4) = 0.78 of its height, so that by samples a peak that is
// 15 % lower, but centred on a pixel, would be higher. A background of -1e-3, which a Gaussian does not have, causes an
// error of 1 % in the height.
TEST(PeakSearch, RanksPeaksByTheirHeightBetweenThePixels) {
  Plane plane(-1e-3f);
  plane.add({4.5, -3.5}, 1.0);
  plane.add({-6.0, 5.0}, 0.85);
  PeakList<float> const found = find_peaks(plane.view(), 8);
  ASSERT_EQ(found.count, 2);
  EXPECT_NEAR(found.peak[0].height, 1.0, 0.01);
  EXPECT_EQ(found.peak[0].y, -4);
  EXPECT_NEAR(found.peak[1].height, 0.85, 0.01);
}

// A regular pattern of pitch 7.16 px: all aliases have the same height. The smallest shift is selected, for
// displacements up to half a pitch along both axes.
TEST(PeakSearch, PrefersTheNearestOfEquallyHighAliases) {
  constexpr double pitch = 7.16;
  for (double const part : {-0.49, -0.25, 0.07, 0.2, 0.45}) {
    Plane plane(-1e-3f);
    Vec2d const shift{part * pitch, -0.8 * part * pitch};
    for (int row = -2; row <= 2; ++row)
      for (int column = -2; column <= 2; ++column) plane.add(shift + pitch * Vec2d{1.0 * column, 1.0 * row}, 1.0);
    PeakList<float> const found = find_peaks(plane.view(), 12);
    ASSERT_EQ(found.count, 3);
    PlanePeak<float> const& first = found.peak[0];
    RefinedPeak<float> const at = refined_peak(plane.view(), first.x, first.y, plane.view()(first.x, first.y));
    EXPECT_NEAR(at.x, shift.x, 0.05) << part;
    EXPECT_NEAR(at.y, shift.y, 0.05) << part;
  }
}

// 0.85 is less than ambiguous_height_ratio: the higher peak remains first, however large its shift.
TEST(PeakSearch, PrefersAFarPeakThatIsClearlyHigher) {
  Plane plane(-1e-3f);
  plane.add({7.0, 7.0}, 1.0);
  plane.add({0.0, 1.0}, 0.85);
  EXPECT_EQ(find_peaks(plane.view(), 8).peak[0].x, 7);
}

}  // namespace
}  // namespace gladstone
