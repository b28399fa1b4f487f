#include "analysis/correlation/window_deformation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"

namespace gladstone {
namespace {

// A spline of degree n reproduces polynomials up to degree n. The reflection at the border disturbs this by
// |pole|^distance, 0.43^45 = 3e-17 for the quintic spline at the centre of 96 pixels, times the reflected slope. The
// remaining error is rounding.
class BsplinePolynomial : public ::testing::TestWithParam<int> {};

TEST_P(BsplinePolynomial, IsReproducedBetweenThePixels) {
  int const degree = GetParam();
  auto const polynomial = [degree](double x, double y) {
    double const s = (x - 48.0) / 10.0, t = (y - 50.0) / 10.0;
    return 2.0 + std::pow(s, degree) - 3.0 * std::pow(t, degree) + s * s * t - 0.5 * s * t + 0.3 * t;
  };
  BsplineImage<double> const image(96, 100, degree, [&](int i, int j) { return polynomial(i, j); });
  for (double dx = -1.5; dx <= 1.5; dx += 0.1875)
    for (double const dy : {-0.9, -0.25, 0.0, 0.5, 1.3}) {
      double const value =
          degree == 3 ? image.view().sample<3>(48, 50, dx, dy) : image.view().sample<5>(48, 50, dx, dy);
      EXPECT_NEAR(value, polynomial(48.0 + dx, 50.0 + dy), 1e-9);
    }
}

TEST_P(BsplinePolynomial, PassesThroughEveryPixelUpToTheBorder) {
  int const degree = GetParam();
  auto const pixel = [](int i, int j) { return static_cast<double>((i * 37 + j * 101) % 256); };
  BsplineImage<double> const image(13, 7, degree, pixel);
  for (int j = 0; j < 7; ++j)
    for (int i = 0; i < 13; ++i)
      EXPECT_NEAR(degree == 3 ? image.view().sample<3>(i, j, 0.0, 0.0) : image.view().sample<5>(i, j, 0.0, 0.0),
                  pixel(i, j), 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Degrees, BsplinePolynomial, ::testing::Values(3, 5));

TEST(BsplineImage, HoldsImagesOfOnePixelAndStaysInsideItsMargin) {
  BsplineImage<double> const image(1, 1, 5, [](int, int) { return 7.0; });
  for (double const far : {-1e6, -3.0, 0.3, 2.5, 1e6}) EXPECT_NEAR(image.view().sample<5>(0, 0, far, far), 7.0, 1e-12);
}

// The relative error of the quintic spline for a wave of 8 px is of the order (2 pi/8)^6 / 30240 = 8e-6 per axis (the
// sixth Bernoulli term); that of a lookup with steps of 1/32 px would be pi/4/64 = 1e-2.
TEST(BsplineImage, ShiftsAWaveWithoutSteps) {
  auto const wave = [](double x) { return std::sin(2.0 * pi * x / 8.0); };
  BsplineImage<double> const image(128, 16, 5, [&](int i, int) { return wave(i); });
  for (double shift = 0.0; shift < 1.0; shift += 0.01)
    EXPECT_NEAR(image.view().sample<5>(64, 8, shift, 0.0), wave(64.0 + shift), 2e-5);
}

// Interpolation over eight pixels with Lanczos' window is exact for constants and at the pixels. For a wave of 8 px the
// error of the sum of its eight terms is at most 0.00593 of its amplitude, over all phases and shifts.
TEST(WindowedSinc, PassesThroughPixelsAndShiftsAWave) {
  auto const pixel = [](int i, int j) { return static_cast<double>((i * 37 + j * 101) % 256); };
  BsplineImage<double> const image(13, 9, windowed_sinc, pixel),
      flat(9, 9, windowed_sinc, [](int, int) { return 7.0; });
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 13; ++i) EXPECT_NEAR(image.view().sample<windowed_sinc>(i, j, 0.0, 0.0), pixel(i, j), 1e-7);
  for (double const far : {-1e6, -3.0, 0.3, 2.5, 1e6})
    EXPECT_NEAR(flat.view().sample<windowed_sinc>(4, 4, far, far), 7.0, 1e-12);
  auto const wave = [](double x) { return std::sin(2.0 * pi * x / 8.0); };
  BsplineImage<double> const waves(128, 16, windowed_sinc, [&](int i, int) { return wave(i); });
  double worst = 0.0;
  for (double shift = 0.0; shift < 1.0; shift += 0.01)
    for (int i = 60; i < 68; ++i)
      worst = std::max(worst, std::abs(waves.view().sample<windowed_sinc>(i, 8, shift, 0.0) - wave(i + shift)));
  EXPECT_LT(worst, 0.00594);
  EXPECT_GT(worst, 0.004);
}

TEST(DensePredictor, ReproducesALinearFieldUpToTheCorners) {
  InterrogationGrid const grid = make_interrogation_grid(100, 90, 16, 0.5);
  auto const field = [](Vec2d p) { return Vec2d{1.0 + 0.02 * p.x - 0.03 * p.y, -2.0 + 0.01 * p.y}; };
  std::vector<Vec2d> nodes;
  for (std::size_t i = 0; i < grid.size(); ++i) nodes.push_back(field(grid.centre(i)));
  DensePredictor const predictor(grid, nodes, 100, 90);
  std::vector<float> u(100), v(100);
  for (int j : {0, 3, 44, 89}) {
    predictor.row(j, u, v);
    for (int i = 0; i < 100; ++i) {
      Vec2d const truth = field({static_cast<double>(i), static_cast<double>(j)});
      EXPECT_NEAR(u[i], truth.x, 1e-6);  // float
      EXPECT_NEAR(v[i], truth.y, 1e-6);
    }
  }
  EXPECT_NEAR(predictor.at({50.25, 40.75}).x, field({50.25, 40.75}).x, 1e-12);
}

// Patterns f(x + d/2) and f(x - d/2) coincide with f after deformation by d. For a wave of 20 grey levels the error of
// the quintic spline is 20 * 0.5^6 / 30240 = 1e-5 per axis, float has some 1e-5 of its sums, and the reflection at the
// edge, 30 px away, 0.43^30. 1e-3 of a grey level is required, in the unit of the pair.
TEST(PairDeformer, BringsBothImagesToTheMiddle) {
  Vec2d const shift{1.7, -0.6};
  auto const pattern = [](double x, double y) { return 100.0 + 20.0 * std::sin(0.4 * x + 0.3) * std::cos(0.5 * y); };
  Image<double> reference(96, 80), flow(96, 80);
  for (int j = 0; j < 80; ++j)
    for (int i = 0; i < 96; ++i) {
      reference(i, j) = pattern(i + 0.5 * shift.x, j + 0.5 * shift.y);
      flow(i, j) = pattern(i - 0.5 * shift.x, j - 0.5 * shift.y);
    }
  InterrogationGrid const grid = make_interrogation_grid(96, 80, 16, 0.5);
  std::vector<Vec2d> const nodes(grid.size(), shift);
  ImagePair const pair = PairDeformer(reference, flow, 5).deform(DensePredictor(grid, nodes, 96, 80));
  // the deformer subtracts one level and multiplies by a power of two, so that the range of almost 40 levels becomes 1
  // to 2
  constexpr double scale = 1.0 / 32.0;
  double const level = pair.reference[40 * 96 + 48] - scale * pattern(48.0, 40.0);
  EXPECT_GT(pair.contrast, 1.0f);
  EXPECT_LT(pair.contrast, 1.25f);
  for (int j = 30; j < 50; ++j)
    for (int i = 30; i < 66; ++i) {
      double const truth = scale * pattern(i, j) + level;
      EXPECT_NEAR(pair.reference[static_cast<std::size_t>(j) * 96 + i], truth, 1e-3 * scale);
      EXPECT_NEAR(pair.flow[static_cast<std::size_t>(j) * 96 + i], truth, 1e-3 * scale);
    }
  // a pixel is known if both of its sources are inside the images: not within |u|/2 = 0.85 px of the edge
  ASSERT_FALSE(pair.available.empty());
  EXPECT_EQ(pair.available[40 * 96 + 0], 0.0f);
  EXPECT_EQ(pair.available[40 * 96 + 1], 1.0f);
  EXPECT_EQ(pair.available[40 * 96 + 95], 0.0f);
}

}  // namespace
}  // namespace gladstone
