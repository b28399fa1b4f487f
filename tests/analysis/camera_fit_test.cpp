#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "analysis/calibration/pinhole_fit.h"
#include "analysis/calibration/soloff_fit.h"

namespace gladstone {
namespace {

constexpr Vec2d middle{511.5, 383.5};

/// A camera at a distance of half a metre, 20 degrees off the normal of the planes, with a short lens and its
/// distortion.
PinholeCamera wide_camera() {
  // R = diag(1, -1, -1) turned by 20 degrees about Y: half a turn about (cos 10, 0, -sin 10)
  double const half = 10 * std::numbers::pi / 180;
  return {{1500, 1500, 515, 380, -0.12, 0.06, 1e-3, -5e-4, std::numbers::pi * std::cos(half), 0,
           -std::numbers::pi * std::sin(half), 0.004, -0.003, 0.5}};
}

/// Dots on planes 20 mm apart as seen by a camera, with normal noise.
CalibrationPoints points_of(PinholeCamera const& camera, double noise_px, unsigned seed = 1, int planes = 3) {
  CalibrationPoints points;
  points.dot_radius = 1e-3;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  for (int k = 0; k < planes; ++k) {
    for (int i = -6; i <= 6; ++i) {
      for (int j = -5; j <= 5; ++j) {
        Vec3d const at{0.024 * i, 0.022 * j, 0.02 * (k - 0.5 * (planes - 1))};
        points.world.push_back(at);
        points.pixel.push_back(camera.image_of_dot(at, points.dot_radius) +
                               noise_px * Vec2d{normal(random), normal(random)});
      }
    }
  }
  return points;
}

// x' of OpenCV's model calculated by hand: a point in the plane y = 0.
TEST(Pinhole, IsOpenCVsModel) {
  PinholeCamera const camera{{1000, 1100, 500, 400, 0.1, 0.01, 0.002, 0.003, 0, 0, 0, 0, 0, 1}};
  double const x = 0.3, r2 = x * x, k = 1 + 0.1 * r2 + 0.01 * r2 * r2;
  Vec2d const pixel = camera.project({0.3, 0, 0});
  EXPECT_NEAR(pixel.x, 500 + 1000 * (x * k + 0.003 * 3 * r2), 1e-9);
  EXPECT_NEAR(pixel.y, 400 + 1100 * 0.002 * r2, 1e-9);
}

// The centroid of a disc's image differs from the image of its centre by (r^2 / 8) times the Laplacian of the map and,
// if the light varies over the disc, by (r^2 / 4) times the slope of the logarithm of the light times the slope of the
// map. From a distance of 1 m and at a slant angle a, d = (x cos a, y, 1 - x sin a). The map is 1000 x cos a / (1 - x
// sin a), with the Laplacian 2000 cos a sin a; the light is (1 - x sin a) / |d|^4, with the logarithmic slope 3 sin a.
TEST(Pinhole, ADotsImageIsNotThatOfItsCentre) {
  double const slant = 0.5, c = std::cos(slant), s = std::sin(slant), radius = 0.01;
  PinholeCamera const camera{{1000, 1000, 0, 0, 0, 0, 0, 0, 0, slant, 0, 0, 0, 1}};
  double const expected = radius * radius * (2000.0 / 8 + 3000.0 / 4) * c * s;
  Vec2d const shift = camera.image_of_dot({}, radius) - camera.project({});
  EXPECT_NEAR(shift.x, expected, 1e-3 * expected);
  EXPECT_NEAR(shift.y, 0, 1e-12);
}

// The light from a point of a slanted plane through the place (x, y) of a pupil at a distance of 1 m is 1 - x tan a, so
// that the weighted mean of x over the pupil is -(R^2 / 4) tan a. A ray through x arrives at x (1 - D) in the plane in
// focus, which is perpendicular to the axis at a distance D: 1000 x (1 - D) / D px. Fourth powers of R, (R / 1 m)^2 =
// 4e-4 of this, are neglected.
TEST(Pinhole, AcrossTheApertureLightFallsOff) {
  double const slant = 0.5, c = std::cos(slant), s = std::sin(slant), R = 0.02, D = 0.8;
  PinholeCamera const camera{{1000, 1000, 0, 0, 0, 0, 0, 0, 0, slant, 0, 0, 0, 1}};
  Vec3d const axis{-s, 0, c};  // in the world
  auto const shift = [&](double focus) {
    return camera.image_of_dot({}, 0, {}, {R, (focus - 1) * axis, axis}) - camera.project({});
  };
  double const expected = -1000 * R * R / 4 * std::tan(slant) * (1 - D) / D;
  EXPECT_NEAR(shift(D).x, expected, 3e-3 * std::abs(expected));
  EXPECT_NEAR(shift(D).y, 0, 1e-12);
  EXPECT_NEAR(length(shift(1)), 0, 1e-9);  // in focus all rays meet
}

TEST(PinholeFit, FindsTheCameraOfExactPoints) {
  PinholeFit const fit = fit_pinhole(points_of(wide_camera(), 0), middle);
  EXPECT_LT(fit.rms_px, 1e-8);
  for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
    double const size = std::max(1e-2, std::abs(wide_camera().value[i]));
    EXPECT_NEAR(fit.camera.value[i], wide_camera().value[i], 1e-7 * size) << PinholeCamera::names[i];
  }
}

// A sensor tilted by 8 degrees: the normal through the lens meets the sensor plane far from the middle of the image.
TEST(PinholeFit, FindsATiltedSensor) {
  PinholeCamera tilted = wide_camera();
  for (std::size_t i = 4; i < 8; ++i) tilted.value[i] = 0;
  tilted.value[2] += 1500 * std::tan(8 * std::numbers::pi / 180);
  tilted.value[9] += 0.2;
  PinholeFit const fit = fit_pinhole(points_of(tilted, 0), middle);
  EXPECT_LT(fit.rms_px, 1e-8);
  EXPECT_NEAR(fit.camera.cx(), tilted.cx(), 1e-4);
}

// The errors of 30 fits divided by their standard errors are normal. The mean of 30 x 14 squares, with independent fits
// and correlated parameters, is 1 with a standard deviation of at most sqrt(2 / 30) = 0.26. The residuals are the
// noise, less 14 of 858 degrees of freedom.
TEST(PinholeFit, StandardErrorsAreThoseThatFitsHave) {
  constexpr int fits = 30;
  constexpr double noise = 0.02;
  double squares = 0, largest = 0;
  for (unsigned seed = 0; seed < fits; ++seed) {
    PinholeFit const fit = fit_pinhole(points_of(wide_camera(), noise, 100 + seed), middle);
    EXPECT_NEAR(fit.rms_px, noise * std::sqrt(844 / 858.0), 4.5 * noise / std::sqrt(2 * 844.0));
    for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
      double const off = (fit.camera.value[i] - wide_camera().value[i]) / fit.standard_error[i];
      squares += off * off;
      largest = std::max(largest, std::abs(off));
    }
  }
  EXPECT_NEAR(squares / (fits * PinholeCamera::count), 1, 3 * std::sqrt(2.0 / fits));
  // A normal number exceeds five standard deviations with a probability of 5.7e-7, one of 30 x 14 with 2.4e-4: in one
  // of 4000 tests.
  EXPECT_LT(largest, 5);
}

// The distortion is determined to 0.01 px where there were dots, for noise of 0.005 px in 429 of them, which is the
// error with 5e5 electrons per dot (DotDetection.ErrorsAreThoseOfTheNoise).
TEST(PinholeFit, DistortionIsKnownToAHundredthOfAPixel) {
  PinholeCamera const truth = wide_camera();
  PinholeFit const fit = fit_pinhole(points_of(truth, 0.005), middle);
  auto const distortion = [](PinholeCamera const& camera, Vec2d at) {
    PinholeCamera here{camera.value};
    for (std::size_t i = 8; i < 14; ++i) here.value[i] = 0;
    here.value[13] = 1;
    PinholeCamera straight = here;
    for (std::size_t i = 4; i < 8; ++i) straight.value[i] = 0;
    return here.project({at.x, at.y, 0}) - straight.project({at.x, at.y, 0});
  };
  double worst = 0;
  for (double x = -0.28; x <= 0.28; x += 0.056) {
    for (double y = -0.22; y <= 0.22; y += 0.044) {
      worst = std::max(worst, length(distortion(fit.camera, {x, y}) - distortion(truth, {x, y})));
    }
  }
  EXPECT_LT(worst, 0.01);
}

TEST(PinholeFit, RejectsDegenerateCalibration) {
  EXPECT_THROW(fit_pinhole(points_of(wide_camera(), 0, 1, 1), middle), std::invalid_argument);
  CalibrationPoints few = points_of(wide_camera(), 0);
  few.world.resize(11);
  few.pixel.resize(11);
  EXPECT_THROW(fit_pinhole(few, middle), std::invalid_argument);
}

/// Image of a dot by a polynomial camera model: its mean over disc_points [px].
Vec2d image_of_dot(SoloffPolynomial const& polynomial, Vec3d centre, double radius) {
  Vec2d pixel{};
  for (std::size_t i = 0; i < polynomial.exponents.size(); ++i) {
    auto const [x, y, z] = polynomial.exponents[i];
    for (Vec2d const off : disc_points) {
      pixel += 0.25 * std::pow(centre.x + radius * off.x, x) * std::pow(centre.y + radius * off.y, y) *
               std::pow(centre.z, z) * polynomial.coefficients[i];
    }
  }
  return pixel;
}

// A map that is such a polynomial is recovered, to rounding.
TEST(SoloffFit, FindsAPolynomial) {
  CalibrationPoints points = points_of(wide_camera(), 0);
  auto const map = [](Vec3d p) {
    return Vec2d{500 + 2e4 * p.x + 1e4 * p.x * p.x * p.z + 3e5 * p.y * p.y * p.y,
                 400 - 2e4 * p.y + 5e4 * p.x * p.z * p.z - 1e5 * p.x * p.y * p.z};
  };
  points.dot_radius = 0;
  for (std::size_t k = 0; k < points.size(); ++k) points.pixel[k] = map(points.world[k]);
  SoloffFit const fit = fit_soloff(points);
  EXPECT_EQ(fit.polynomial.exponents.size(), 19u);
  EXPECT_LT(fit.rms_px, 1e-10);
  Vec3d const at{0.031, -0.02, 0.017};
  // The residual is rounding, 1e-13 of 1e3 px for each of some hundred terms and sums; single points have up to ten
  // times the limit of its rms.
  EXPECT_LT(length(image_of_dot(fit.polynomial, at, 0) - map(at)), 1e-9);
}

// The map of a pinhole camera is not a polynomial, but the fit approximates it as well as the residuals state.
TEST(SoloffFit, FollowsAPinholeCamera) {
  PinholeCamera const camera = wide_camera();
  SoloffFit const fit = fit_soloff(points_of(camera, 0));
  Vec3d const at{0.013, 0.027, 0.011};
  // The error is mainly that of the omitted fourth order. A Legendre polynomial of order 4 is at most sqrt(2 * 4 + 1) =
  // 3 times its rms; the factor 4 includes the higher orders.
  EXPECT_LT(length(image_of_dot(fit.polynomial, at, 1e-3) - camera.image_of_dot(at, 1e-3)), 4 * fit.rms_px);
  EXPECT_GT(fit.rms_px, 1e-4);
  EXPECT_LT(fit.rms_px, 1);
}

TEST(SoloffFit, TwoPlanesLeaveOutTheSquareOfZ) {
  SoloffFit const fit = fit_soloff(points_of(wide_camera(), 0, 1, 2));
  EXPECT_EQ(fit.polynomial.exponents.size(), 16u);
  EXPECT_THROW(fit_soloff(points_of(wide_camera(), 0, 1, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace gladstone
