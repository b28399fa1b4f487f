#include "analysis/correlation/subpixel_fit.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gladstone {
namespace {

/// exp(-(a u^2 + 2 b u v + c v^2)) about (x, y), times its height.
PeakPatch gaussian_patch(double x, double y, double a, double b, double c) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      double const u = i - x, v = j - y;
      patch.value[j + 1][i + 1] = 3.0 * std::exp(-(a * u * u + 2.0 * b * u * v + c * v * v));
    }
  return patch;
}

TEST(Gauss3, IsExactForGaussiansAlongTheAxes) {
  PeakPatch const patch = gaussian_patch(0.31, -0.27, 0.7, 0.0, 0.4);
  PeakFit const fit = fit_gauss3(patch);
  EXPECT_NEAR(fit.x, 0.31, 1e-12);
  EXPECT_NEAR(fit.y, -0.27, 1e-12);
  EXPECT_NEAR(patch.value[1][1] * std::exp(fit.log_rise), 3.0, 1e-12);
}

// Six terms of the logarithm fitted to nine points are exact; three points along each axis do not include the tilt.
TEST(Gauss2d, IsExactForTiltedGaussians) {
  PeakPatch const patch = gaussian_patch(0.31, -0.27, 0.7, 0.3, 0.4);
  PeakFit const fit = fit_gauss2d(patch);
  EXPECT_NEAR(fit.x, 0.31, 1e-12);
  EXPECT_NEAR(fit.y, -0.27, 1e-12);
  EXPECT_NEAR(patch.value[1][1] * std::exp(fit.log_rise), 3.0, 1e-12);
  // log v(x, 0) has its vertex where a (i - x) = b y: an error of b y/a
  EXPECT_NEAR(fit_gauss3(patch).x, 0.31 + 0.3 * -0.27 / 0.7, 1e-12);
}

TEST(Gauss2d, UsesThreePointsIfThePatchIsNoPeak) {
  PeakPatch patch = gaussian_patch(0.2, 0.1, 0.7, 0.0, 0.4);
  patch.value[0][0] = -0.1;
  EXPECT_EQ(fit_gauss2d(patch).x, fit_gauss3(patch).x);
}

TEST(Parabola, IsExactForParabolas) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) patch.value[j + 1][i + 1] = 5.0 - 2.0 * (i - 0.3) * (i - 0.3) - (j + 0.2) * (j + 0.2);
  PeakFit const fit = fit_parabola(patch);
  EXPECT_NEAR(fit.x, 0.3, 1e-12);
  EXPECT_NEAR(fit.y, -0.2, 1e-12);
  EXPECT_NEAR(patch.value[1][1] * std::exp(fit.log_rise), 5.0, 1e-12);
}

// The centroid of 1, 4, 2 is (2 - 1)/(1 + 4 + 2); that of -1, 4, 2 is 2/6.
TEST(Centroid, IsTheCentreOfMass) {
  PeakPatch patch{{{0.5, 1.0, 0.5}, {1.0, 4.0, 2.0}, {0.5, 1.0, 0.5}}};
  EXPECT_DOUBLE_EQ(fit_centroid(patch).x, 1.0 / 7);
  EXPECT_DOUBLE_EQ(fit_centroid(patch).y, 0.0);
  patch.value[1][0] = -1.0;
  EXPECT_DOUBLE_EQ(fit_centroid(patch).x, 1.0 / 3);
}

// Each pass adds the fit to the residual displacement: the iteration converges if the slope of the fit is between 0 and
// 2, whatever the width of the peak.
TEST(EverySubpixelFit, LetsPassesConverge) {
  for (std::string const& name : subpixel_fits()) {
    for (double const width : {0.7, 1.06, 1.5, 2.5}) {
      double const inverse = 1 / (width * width), step = 1e-3;
      double const slope = subpixel_method(name).fit(gaussian_patch(step, 0.0, inverse, 0.0, inverse)).x / step;
      EXPECT_GT(slope, 0.05) << name << ' ' << width;
      EXPECT_LT(slope, 1.95) << name << ' ' << width;
    }
  }
}

// By symmetry the fit to a symmetric peak is 0.
TEST(EverySubpixelFit, LeavesSymmetricPeaksWhereTheyAre) {
  for (std::string const& name : subpixel_fits()) {
    PeakFit const fit = subpixel_method(name).fit(gaussian_patch(0.0, 0.0, 0.5, 0.0, 0.8));
    EXPECT_NEAR(fit.x, 0.0, 1e-12) << name;
    EXPECT_NEAR(fit.y, 0.0, 1e-12) << name;
    EXPECT_NEAR(fit.log_rise, 0.0, 1e-12) << name;
  }
}

}  // namespace
}  // namespace gladstone
