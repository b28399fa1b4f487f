#include "analysis/tracking/dot_location.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cstdio>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "tests/analysis/synthetic_dots.h"
#include "tests/support/poisson_variate.h"

namespace gladstone::inline tracking {
namespace {

using test::SyntheticDot;

constexpr double height = 40000, background = 500;

/// Cramer-Rao bound of the centre of a dot with unknown height, width and background, for uniform normal noise
/// (Rajendran, Bane & Vlachos 2020): the Fisher information is J^T J / noise^2 with the derivatives J of the levels,
/// here by central differences of the image formula.
Vec2d cramer_rao_bound(SyntheticDot const& dot, double noise) {
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  constexpr double h = 1e-4;
  for (int row = static_cast<int>(dot.centre.y) - 10; row <= dot.centre.y + 10; ++row)
    for (int column = static_cast<int>(dot.centre.x) - 10; column <= dot.centre.x + 10; ++column) {
      auto const slope = [&](auto const& change) {
        SyntheticDot low = dot, high = dot;
        change(low, -h);
        change(high, h);
        return (light_on(high, column, row) - light_on(low, column, row)) / (2 * h);
      };
      Eigen::Matrix<double, 5, 1> by;
      by << slope([](SyntheticDot& d, double by_h) { d.centre.x += by_h; }),
          slope([](SyntheticDot& d, double by_h) { d.centre.y += by_h; }),
          slope([](SyntheticDot& d, double by_h) { d.height += by_h; }), slope([](SyntheticDot& d, double by_h) {
            d.sigma_x += by_h;
            d.sigma_y += by_h;
          }),
          1;
      information += by * by.transpose() / (noise * noise);
    }
  Eigen::Matrix<double, 5, 5> const covariance = information.inverse();
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1))};
}

/// Isolated dots at all pixel phases: on a grid of 19 px plus a step of the phase.
std::vector<SyntheticDot> isolated_dots(double sigma, Vec2d shift = {}) {
  std::vector<SyntheticDot> dots;
  for (int j = 0; j < 12; ++j)
    for (int i = 0; i < 12; ++i)
      dots.push_back({shift + Vec2d{12 + 19 * i + i / 12.0, 12 + 19 * j + j / 12.0}, height, sigma, sigma});
  return dots;
}

/// Returns the index of the located dot nearest to a place, if it is within a radius; -1 otherwise.
int nearest_dot(LocatedDots const& located, Vec2d place, double radius) {
  int best = -1;
  for (std::size_t k = 0; k < located.dots.size(); ++k) {
    double const apart = length(located.dots[k].image.centre - place);
    if (!(apart < radius)) continue;
    radius = apart;
    best = static_cast<int>(k);
  }
  return best;
}

/// Rms errors of the located dots, relative to the bound and relative to their stated uncertainty.
struct Accuracy {
  double over_bound = 0, over_sigma = 0;
};

/// Displacement errors of isolated dots between two noisy frames, as ratios of root mean squares.
Accuracy displacement_accuracy(double sigma, double noise_share, DotSettings const& settings) {
  Vec2d const shift{0.37, -0.21};
  double const noise = noise_share * height;
  std::vector<SyntheticDot> const a = isolated_dots(sigma), b = isolated_dots(sigma, shift);
  std::vector<double> variance;  // bound of the displacement, both components
  for (std::size_t i = 0; i < a.size(); ++i) {
    Vec2d const of_a = cramer_rao_bound(a[i], noise), of_b = cramer_rao_bound(b[i], noise);
    variance.push_back(dot(of_a, of_a) + dot(of_b, of_b));
  }
  double squares = 0, bounds = 0, normalised = 0;
  int count = 0;
  for (int repeat = 0; repeat < 3; ++repeat) {
    KeyedEngine random(11, RandomStream::sensor, static_cast<std::uint64_t>(repeat));
    LocatedDots const in_a = locate_dots(test::dot_image(240, a, background + 5 * noise, noise, random), settings);
    LocatedDots const in_b = locate_dots(test::dot_image(240, b, background + 5 * noise, noise, random), settings);
    // At five standard deviations, noise of 57600 pixels imitates a dot in one of a hundred frames.
    EXPECT_LE(in_a.dots.size(), a.size() + 1);
    EXPECT_LE(in_b.dots.size(), b.size() + 1);
    for (std::size_t i = 0; i < a.size(); ++i) {
      int const k = nearest_dot(in_a, a[i].centre, 1), m = nearest_dot(in_b, b[i].centre, 1);
      if (k < 0 || m < 0) continue;
      LocatedDot const &p = in_a.dots[static_cast<std::size_t>(k)], &q = in_b.dots[static_cast<std::size_t>(m)];
      Vec2d const error = q.image.centre - p.image.centre - shift;
      squares += dot(error, error);
      bounds += variance[i];
      normalised += error.x * error.x / (p.sigma_px.x * p.sigma_px.x + q.sigma_px.x * q.sigma_px.x) +
                    error.y * error.y / (p.sigma_px.y * p.sigma_px.y + q.sigma_px.y * q.sigma_px.y);
      ++count;
    }
  }
  EXPECT_EQ(count, 3 * static_cast<int>(a.size()));
  return {std::sqrt(squares / bounds), std::sqrt(normalised / (2 * count))};
}

// No unbiased estimate has a smaller variance than the Cramer-Rao bound, and a least-squares fit attains it if the
// noise is small against the dot. 864 errors determine their rms to 1/sqrt(2 * 864) = 2.4 %; the prescribed margin
// is 1.3.
TEST(DotLocation, ErrorsOfIsolatedDotsAttainTheCramerRaoBound) {
  for (double const diameter : {2.0, 3.0, 5.0})
    for (double const noise : {0.01, 0.02, 0.05}) {
      Accuracy const accuracy = displacement_accuracy(diameter / 4, noise, {});
      std::printf("diameter %.0f px, noise %.0f %%: rms over bound %.3f, over sigma %.3f\n", diameter, 100 * noise,
                  accuracy.over_bound, accuracy.over_sigma);
      EXPECT_LT(accuracy.over_bound, 1.3) << diameter << " px, noise " << noise;
      EXPECT_GT(accuracy.over_bound, 0.85) << diameter << " px, noise " << noise;
      EXPECT_NEAR(accuracy.over_sigma, 1.0, 0.15) << diameter << " px, noise " << noise;
    }
}

// An elliptic fit has two more parameters, which are independent of the centre by symmetry.
TEST(DotLocation, EllipticFitsOfRoundDotsAreAsAccurate) {
  DotSettings settings;
  settings.shape = DotShape::elliptic;
  Accuracy const accuracy = displacement_accuracy(0.75, 0.02, settings);
  EXPECT_LT(accuracy.over_bound, 1.3);
  EXPECT_NEAR(accuracy.over_sigma, 1.0, 0.15);
}

// Without noise, the model is the image formula; the errors are those of rounding to 16 bits: 0.29 levels, over 40000.
TEST(DotLocation, HasNoErrorDependingOnThePixelPhase) {
  KeyedEngine random(3, RandomStream::sensor, 0);
  std::vector<SyntheticDot> const dots = isolated_dots(0.75);
  LocatedDots const located = locate_dots(test::dot_image(240, dots, background, 0, random), {});
  ASSERT_EQ(located.dots.size(), dots.size());
  for (SyntheticDot const& dot : dots) EXPECT_GE(nearest_dot(located, dot.centre, 5e-5), 0) << dot.centre.x;
}

TEST(DotLocation, FindsTheMomentsOfEllipticDots) {
  KeyedEngine random(3, RandomStream::sensor, 0);
  std::vector<SyntheticDot> dots = isolated_dots(0.75);
  for (SyntheticDot& dot : dots) dot.sigma_x = 1.1;
  DotSettings settings;
  settings.shape = DotShape::elliptic;
  LocatedDots const located = locate_dots(test::dot_image(240, dots, background, 40, random), settings);
  ASSERT_EQ(located.dots.size(), dots.size());
  for (LocatedDot const& dot : located.dots) {
    EXPECT_NEAR(dot.image.xx, 1.21, 0.02);
    EXPECT_NEAR(dot.image.yy, 0.5625, 0.02);
    EXPECT_NEAR(dot.image.xy, 0, 0.01);
  }
}

// Dark dots on paper whose illumination falls off linearly: the background is local.
TEST(DotLocation, FindsDarkDotsOnUnevenPaper) {
  KeyedEngine random(5, RandomStream::sensor, 0);
  std::vector<SyntheticDot> dots = isolated_dots(0.75);
  Image<double> image(240, 240);
  for (int row = 0; row < 240; ++row)
    for (int column = 0; column < 240; ++column) image(column, row) = 50000 + 20 * column - 15 * row;
  for (SyntheticDot& dot : dots) dot.height = -30000;
  test::add_dots(image, dots);
  for (double& level : image) level = std::floor(level + 300 * normal_variate(random) + 0.5);
  LocatedDots const located = locate_dots(image, {});
  EXPECT_FALSE(located.bright);
  ASSERT_EQ(located.dots.size(), dots.size());
  EXPECT_NEAR(located.noise, 300, 15);
  // bound 0.0094 px at 1 % noise; the largest of 288 errors is 3.0 times the rms
  for (SyntheticDot const& dot : dots) EXPECT_GE(nearest_dot(located, dot.centre, 0.06), 0);
}

/// Result of the location in a whole frame: found dots and wrongly located dots, away from the edge.
struct Yield {
  double found = 0;  ///< fraction located within half a pixel; each located dot counts for one true dot only
  int strays = 0;    ///< number of located dots that do not belong to a true dot
};

Yield measure_yield(double apart, double noise_share, double dots_per_window) {
  constexpr int side = 256;
  KeyedEngine random(7, RandomStream::target, 1);
  auto const places =
      test::random_places(static_cast<std::size_t>(dots_per_window * side * side / 1024), side, apart, random);
  std::vector<SyntheticDot> dots;
  for (Vec2d const place : places) dots.push_back({place, height});
  double const noise = noise_share * height;
  LocatedDots const located = locate_dots(test::dot_image(side, dots, background + 5 * noise, noise, random), {});
  auto const inside = [&](Vec2d p) { return p.x > 3 && p.y > 3 && p.x < side - 4 && p.y < side - 4; };
  std::vector<char> used(located.dots.size());
  int all = 0, found = 0;
  for (Vec2d const place : places) {
    int const k = nearest_dot(located, place, 0.5);
    bool const own = k >= 0 && !used[static_cast<std::size_t>(k)];
    if (own) used[static_cast<std::size_t>(k)] = 1;
    if (!inside(place)) continue;
    ++all;
    found += own ? 1 : 0;
  }
  Yield result{static_cast<double>(found) / all, 0};
  for (std::size_t k = 0; k < used.size(); ++k)
    if (!used[k] && inside(located.dots[k].image.centre)) ++result.strays;
  std::printf("%.0f dots per window, at least %.0f px apart, noise %.0f %%: yield %.4f of %d, strays %d\n",
              dots_per_window, apart, 100 * noise_share, result.found, all, result.strays);
  return result;
}

// 20 dots of 3 px per 32x32 px that do not overlap: the pattern of the renderers.
TEST(DotLocation, FindsAllDotsOfADensePattern) {
  for (double const noise : {0.01, 0.05}) {
    Yield const found = measure_yield(3, noise, 20);
    EXPECT_GE(found.found, 0.995) << noise;
    EXPECT_LE(found.strays, 2) << noise;
  }
}

// At random places, 13 % of the dots have a neighbour within 1.5 px, and 1.5 % within 0.5 px. Two dots closer than
// 1.5 px have a common maximum.
TEST(DotLocation, SeparatesMostOverlappingDotsAtRandomPlaces) {
  Yield const found = measure_yield(0, 0.01, 20);
  EXPECT_GE(found.found, 0.985);
  EXPECT_LE(found.strays, 8);
  EXPECT_GE(measure_yield(0, 0.05, 20).found, 0.95);
}

// For a camera with shot noise, the errors agree with the stated uncertainty, with the gain estimated from the frame.
TEST(DotLocation, UncertaintyFollowsShotNoise) {
  constexpr double levels_per_electron = 20, read_noise = 60;
  KeyedEngine random(9, RandomStream::sensor, 0);
  std::vector<SyntheticDot> const dots = isolated_dots(0.75);
  Image<double> image(240, 240, background);
  test::add_dots(image, dots);
  for (double& level : image)
    level = std::floor(levels_per_electron * poisson_variate(random, level / levels_per_electron) +
                       read_noise * normal_variate(random) + 0.5);
  LocatedDots const located = locate_dots(image, {});
  ASSERT_EQ(located.dots.size(), dots.size());
  EXPECT_NEAR(located.gain / levels_per_electron, 1.0, 0.25);
  double normalised = 0;
  for (SyntheticDot const& dot : dots) {
    int const k = nearest_dot(located, dot.centre, 1);
    ASSERT_GE(k, 0);
    LocatedDot const& found = located.dots[static_cast<std::size_t>(k)];
    Vec2d const error = found.image.centre - dot.centre;
    normalised += std::pow(error.x / found.sigma_px.x, 2) + std::pow(error.y / found.sigma_px.y, 2);
  }
  // The root of the mean of 288 squares scatters by 1 / sqrt(2 * 288) = 4.2 %. The gain is estimated from medians of
  // some 1500 squares, which scatter by 7 %, and half of that enters sigma. Three standard deviations of both together
  // are 16 %; the factor sqrt(max(1, chi2 / freedom)) adds up to 4 %.
  EXPECT_NEAR(std::sqrt(normalised / (2.0 * static_cast<double>(dots.size()))), 1.0, 0.2);
}

// Normal noise that is the same on all pixels has no part that grows with the light.
TEST(DotLocation, FindsNoShotNoiseInUniformNoise) {
  KeyedEngine random(10, RandomStream::sensor, 0);
  LocatedDots const located = locate_dots(test::dot_image(240, isolated_dots(0.75), background, 400, random), {});
  EXPECT_LT(located.gain * height, 400 * 400);
}

TEST(DotLocation, FindsNothingInNoiseAndIgnoresMaskedPixels) {
  KeyedEngine random(13, RandomStream::sensor, 0);
  EXPECT_LE(locate_dots(test::dot_image(128, {}, background, 30, random), {}).dots.size(), 1u);
  EXPECT_TRUE(locate_dots(Image<double>(128, 128, 7.0), {}).dots.empty());
  EXPECT_TRUE(locate_dots(Image<double>(3, 3, 7.0), {}).dots.empty());
  EXPECT_TRUE(locate_dots(Image<double>(64, 64, not_a_number), {}).dots.empty());
  std::vector<SyntheticDot> const dots = isolated_dots(0.75);
  Image<double> image = test::dot_image(240, dots, background, 400, random);
  for (int row = 0; row < 240; ++row)
    for (int column = 0; column < 120; ++column) image(column, row) = not_a_number;
  LocatedDots const located = locate_dots(image, {});
  auto const right = [](Vec2d p) { return p.x > 124; };
  auto const expected = std::count_if(dots.begin(), dots.end(), [&](auto const& dot) { return right(dot.centre); });
  EXPECT_EQ(
      std::count_if(located.dots.begin(), located.dots.end(), [&](auto const& dot) { return right(dot.image.centre); }),
      expected);
}

TEST(DotLocation, DoesNotDependOnTheNumberOfThreads) {
  KeyedEngine random(7, RandomStream::target, 1);
  std::vector<SyntheticDot> dots;
  for (Vec2d const place : test::random_places(320, 128, 0, random)) dots.push_back({place, height});
  Image<double> const image = test::dot_image(128, dots, background, 400, random);
  int const threads = thread_count();
  std::vector<LocatedDots> results;
  for (int const count : {1, 3}) {
    set_thread_count(count);
    results.push_back(locate_dots(image, {}));
  }
  set_thread_count(threads);
  ASSERT_EQ(results[0].dots.size(), results[1].dots.size());
  for (std::size_t i = 0; i < results[0].dots.size(); ++i) {
    EXPECT_EQ(results[0].dots[i].image.centre, results[1].dots[i].image.centre);
    EXPECT_EQ(results[0].dots[i].sigma_px, results[1].dots[i].sigma_px);
  }
}

}  // namespace
}  // namespace gladstone::inline tracking
