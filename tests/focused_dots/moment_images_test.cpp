#include "render/focused_dots/moment_images.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/focused_dots/dot_model.h"
#include "render/focused_dots/dot_patch.h"
#include "render/focused_dots/square_light.h"
#include "render/scene/source_cubature.h"

namespace gladstone {
namespace {

// Squares tile the sensor: their centres are recovered from pixel and offset, on either side of the sensor's edge.
TEST(MomentLattice, PutsSquaresOnPixels) {
  for (double const most : {0.23, 0.4, 0.5, 0.99, 1.0, 3.7}) {
    MomentLattice const lattice = MomentLattice::no_coarser(most);
    EXPECT_LE(lattice.side(), most);
    EXPECT_GT(lattice.side(), 0.5 * most);
    EXPECT_DOUBLE_EQ(lattice.side() * lattice.per_side(), 1);
    for (int square = -25; square <= 25; ++square) {
      int const phase = lattice.phase(square);
      ASSERT_GE(phase, 0);
      ASSERT_LT(phase, lattice.per_pixel);
      EXPECT_LE(std::abs(lattice.offset(phase) - MomentLattice::aside), 0.5);
      EXPECT_NEAR(lattice.pixel(square) + lattice.offset(phase), square * lattice.side() + MomentLattice::aside, 1e-12);
    }
  }
}

TEST(DotSquares, CountDisplacementsFromTheMiddlesOfTheSensorsSquares) {
  MomentLattice const lattice = MomentLattice::no_coarser(0.4);
  Vec2d const origin{101.87, -3.21};
  for (int const step : {1, 2, 4})
    for (Vec2d const displacement : {Vec2d{0, 0}, Vec2d{0.7, -2.3}, Vec2d{-5.01, 4.4}}) {
      DotSquares const squares(lattice, origin, step);
      Vec2<int> const square = squares.square_of(displacement);
      Vec2d const rest = squares.from_middle(displacement, square);
      EXPECT_LE(std::abs(rest.x), 0.5 * step * lattice.side() + 1e-12);
      EXPECT_LE(std::abs(rest.y), 0.5 * step * lattice.side() + 1e-12);
      Vec2<int> const on_sensor = squares.on_sensor(square);
      EXPECT_NEAR(on_sensor.x * lattice.side() + MomentLattice::aside + rest.x, origin.x + displacement.x, 1e-11);
      EXPECT_NEAR(on_sensor.y * lattice.side() + MomentLattice::aside + rest.y, origin.y + displacement.y, 1e-11);
    }
}

/// Returns the light of a buffer at pixels 0 to 63.
Image<double> light_of(DotPatch& patch) {
  LightImage image(64, 64);
  patch.flush(&image, 1);
  return image.to_light();
}

struct Source {
  char const* name;
  double half_px, sigma;
};
class SpreadSource : public testing::TestWithParam<Source> {};

// A disc whose points have displacements d = d0 + s (x, -y / 2), linear in the position, is the sum of the PSFs of its
// displaced points, up to the fifth order of the series in |d| / sigma, with d from the square's centre. For the PSF of
// a point, the remainder is 5.8 |d / sigma|^5 / 5! (He_5 times the Gaussian) along each axis, and less than as much
// again for the cross terms. For a disc, it only acts at the rim, and less, by the ratio to He_4's maximum, 2.3 / 5.8.
TEST_P(SpreadSource, IsTheSumOfItsPointsWhereTheyAreMoved) {
  auto const [name, half_px, sigma] = GetParam();
  SourceCubature const source = SourceCubature::make(SourceShape::disc, half_px, sigma);
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian.sigma = sigma;
  DotModel model;
  model.spot = spot.gaussian;
  model.source_half = half_px > 0 ? 1e-3 : 0;
  double const side = model.most_square_side();
  int const terms = half_px > 0 ? PlaceRule::terms : 1;
  MomentImages images = MomentImages::plan(half_px, spot.gaussian, side, terms);
  ASSERT_TRUE(images.exist());
  std::vector<double> const values =
      make_moment_images(images, {source.points.data(), source.weights.data(), static_cast<int>(source.points.size())},
                         half_px, spot.gaussian);
  images.values = values.data();
  double const slope = half_px > 0 ? 0.02 * side : 0;
  for (Vec2d const at : {Vec2d{30.1, 33.4}, Vec2d{29.51, 31.98}, Vec2d{32.77, 30.26}}) {
    DotSquares const squares(images.lattice, at, 1);
    Vec2d const d0{0.61, -0.87};
    Vec2<int> const square = squares.square_of(d0);
    Vec2d const rest = squares.from_middle(d0, square);
    DotPatch direct(spot, images), by_moments(spot, images);
    // moments as functions of the position, term by term: (rest.x + s x)^a (rest.y - s y / 2)^b up to second order in s
    MomentField field{};
    for (int a = 0; a <= DisplacementMoments::order; ++a) {
      for (int b = 0; a + b <= DisplacementMoments::order; ++b) {
        double* const of = field.coefficient[DisplacementMoments::at(a, b)];
        auto const power = [](double x, int n) { return n < 0 ? 0.0 : std::pow(x, n); };
        double const sx = slope, sy = -0.5 * slope;
        of[0] = power(rest.x, a) * power(rest.y, b);
        of[1] = a * power(rest.x, a - 1) * sx * power(rest.y, b);
        of[2] = b * power(rest.y, b - 1) * sy * power(rest.x, a);
        of[3] = 0.5 * a * (a - 1) * power(rest.x, a - 2) * sx * sx * power(rest.y, b);
        of[4] = a * power(rest.x, a - 1) * sx * b * power(rest.y, b - 1) * sy;
        of[5] = 0.5 * b * (b - 1) * power(rest.y, b - 2) * sy * sy * power(rest.x, a);
      }
    }
    SquareSums<1> sums;
    sums.range = {square, square};
    for (int k = 0; k < images.count(); ++k) sums.shares[k][0] = 2.5 * field.coefficient[k / terms][k % terms];
    unsigned short const first = 0;
    add_squares<MomentImages::pad>(OneLane{}, images, squares, &first, 1, sums, by_moments);
    for (std::size_t i = 0; i < source.points.size(); ++i) {
      Vec2d const p = source.points[i];
      Vec2d const moved = d0 + slope * Vec2d{p.x, -0.5 * p.y};
      direct.deposit(at + half_px * p + moved, 2.5 * source.weights[i], nullptr, 1);
    }
    Image<double> const expected = light_of(direct), found = light_of(by_moments);
    double const peak = *std::max_element(expected.begin(), expected.end());
    double sum = 0, worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      sum += found.data()[i];
      worst = std::max(worst, std::abs(found.data()[i] - expected.data()[i]));
    }
    auto const fifth = [sigma = sigma](double d) { return 5.8 / 120 * std::pow(std::abs(d) / sigma, 5); };
    double const bound = 2 * (fifth(std::abs(rest.x) + slope) + fifth(std::abs(rest.y) + slope));
    EXPECT_LT(worst / peak, (half_px > 0 ? 0.4 : 1.0) * bound + 1e-5) << name << " at " << at.x;
    EXPECT_NEAR(sum, 2.5, 2.5e-4) << name;
  }
}
INSTANTIATE_TEST_SUITE_P(Dots, SpreadSource,
                         testing::Values(Source{"fine", 1.4, 0.28}, Source{"wide_spot", 2.0, 1.3},
                                         Source{"large", 9.0, 0.6}, Source{"point", 0.0, 0.5},
                                         Source{"finest", 1.4, 0.1}, Source{"fine_point", 0.0, 0.14}),
                         [](auto const& instance) { return std::string(instance.param.name); });

// Sources so large that their images would need too much memory have no moment images.
TEST(MomentImages, AreNotMadeWhereTheyWouldTakeTooMuchMemory) {
  GaussianSpot<double> const spot{0.28};
  EXPECT_TRUE(MomentImages::plan(20, spot, 0.4, PlaceRule::terms).exist());
  EXPECT_FALSE(MomentImages::plan(400, spot, 0.4, PlaceRule::terms).exist());
}

}  // namespace
}  // namespace gladstone
