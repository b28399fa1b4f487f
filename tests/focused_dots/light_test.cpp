#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "render/base/units.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

double sum_of(Image<double> const& image) { return std::accumulate(image.begin(), image.end(), 0.0); }

Vec2d centroid_of(Image<double> const& image) {
  Vec2d sum{};
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns(); ++column) {
      sum += image(column, row) * Vec2d{double(column), double(row)};
    }
  }
  return sum / sum_of(image);
}

// The image and the flux of an isolated dot inside the frame contain the light of its area, pi d^2/4 (cos^4 reduces it
// by 2.3e-5), in both frames, since a uniform gradient neither magnifies nor focuses. The number of rays that pass the
// stop varies by one stratum of the samples, 1/512.
TEST(Light, OfADotsImageIsItsFlux) {
  for (SpotModel const spot :
       {SpotModel::gaussian, SpotModel::airy, SpotModel::gaussian_first_zero, SpotModel::seed_eq8, SpotModel::none}) {
    auto setup = table1_setup(64);
    setup.lens.spot = spot;
    setup.medium.field = uniform_gradient(60, -80);
    // the stop's edge cuts the discs to which rays are sent: N^(-3/4) for N points, 1.2e-3 for 8192
    bool const by_rays = spot == SpotModel::airy || spot == SpotModel::none;
    PlannedScene scene = scene_with_dots(setup, {{30.3, 33.8}}, by_rays ? 8192 : 32);
    Rendering const rendering = render_all(scene);
    Vec2d const flux = rendering.truth.flux[0];
    double const reference = sum_of(rendering.light.reference), flow = sum_of(rendering.light.flow);
    for (double const light : {reference, flow, flux.x, flux.y}) {
      EXPECT_NEAR(light / (pi / 4 * 9), 1, by_rays ? 1.5 / 512 : 1e-4) << static_cast<int>(spot);
    }
  }
}

// A bright dot of diameter d on the axis has the light of pi d^2/4 fully lit pixels, times the mean cos^4 of its cone,
// 1 - 2 <theta^2> = 1 - 2 (4.773 mm)^2/2; off the axis, times cos^4.
TEST(Light, IsTheDotsAreaTimesTheMeanCosFour) {
  auto const setup = table1_setup(128);
  double const area = pi / 4 * 9, cone = 1 - std::pow(0.105 / 22, 2);
  PlannedScene scene = scene_with_dots(setup, {{63.5, 63.5}, {10, 20}}, 64);
  GroundTruth const truth = trace_truth(scene);
  EXPECT_NEAR(truth.flux[0].x / area, cone, 1e-8);
  double const cosine2 = 1 / (1 + dot(scene.dots.centre[1], scene.dots.centre[1]));
  EXPECT_NEAR(truth.flux[1].x / area, cone * cosine2 * cosine2, 1e-5);
}

// The middle of a dot of 40 px is like white paper: light 1 per pixel. The mean over 11 x 11 px contains a tenth of the
// 2^15 points of a net; its relative error is below sqrt(1/6000) = 1.3 % even for independent points.
TEST(Light, OfAFullyLitAreaIsOne) {
  auto setup = table1_setup(64);
  setup.target.dot_diameter_px = 40;
  PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 1 << 15);
  Rendering const rendering = render_all(scene);
  double mean = 0;
  for (int row = 26; row < 37; ++row) {
    for (int column = 26; column < 37; ++column) mean += rendering.light.reference(column, row) / 121;
  }
  EXPECT_NEAR(mean, 1, 0.013);
}

// PSFs that are symmetric about their ray preserve the centroid, up to the aliasing of pixels, exp(-2 pi^2 sigma^2)/pi
// < 1e-13 px at sigma = 1.25 px; a footprint ends at 5.5 sigma. The dot in the image has the position and the flux of
// the truth, in both frames, up to the scatter of 2^13 rays in a dot of 0.75 px standard deviation: 0.75 px/2^6.5 =
// 8e-3 px at worst.
TEST(Light, OfADotIsCentredWhereTruthSays) {
  auto setup = table1_setup(64);
  setup.lens.spot = SpotModel::seed_eq8;
  setup.medium.field = dns_plane("kepeak");
  for (Vec2d const at : {Vec2d{31.5, 31.5}, Vec2d{28.2, 35.7}, Vec2d{36.1, 27.4}}) {
    PlannedScene scene = scene_with_dots(setup, {at}, 1 << 13);
    Rendering const rendering = render_all(scene);
    Vec2d const reference = centroid_of(rendering.light.reference), flow = centroid_of(rendering.light.flow);
    Vec2d const shift = rendering.truth.displacement_px[0];
    EXPECT_GT(length(shift), 0.01);
    EXPECT_NEAR(sum_of(rendering.light.reference) / rendering.truth.flux[0].x, 1, 3e-3);
    EXPECT_NEAR(sum_of(rendering.light.flow) / rendering.truth.flux[0].y, 1, 3e-3);
    EXPECT_LT(length(reference - rendering.truth.reference_px[0]), 5e-3);
    EXPECT_LT(length(flow - reference - shift), 1e-3);
  }
}

// A smaller sensor about the same axis records the same image as a larger one, for dots inside, across and outside its
// border. Only the rounding to fixed point differs, by about 1e-13.
TEST(Light, AtTheBorderIsThatOfALargerSensor) {
  std::vector<Vec2d> const small_px{{20.3, 30.4}, {-1.2, 27.3}, {63.4, 20.1}, {31.7, 64.6}, {-4.3, -3.6}, {66.2, 65.9}};
  std::vector<Vec2d> large_px = small_px;
  for (Vec2d& p : large_px) p += {16, 16};
  for (FieldSetup const& field : {FieldSetup{}, sinusoid(0.2, 4e-3), dns_plane("kepeak")}) {
    auto setup = table1_setup(64);
    setup.medium.field = field;
    PlannedScene small = scene_with_dots(setup, small_px, 100);
    setup.camera.columns = setup.camera.rows = 96;
    PlannedScene large = scene_with_dots(setup, large_px, 100);
    Rendering const seen = render_all(small), whole = render_all(large);
    EXPECT_GT(seen.light.flow(0, 27), 0.05);
    for (int row = 0; row < 64; ++row) {
      for (int column = 0; column < 64; ++column) {
        ASSERT_NEAR(seen.light.reference(column, row), whole.light.reference(column + 16, row + 16), 1e-9);
        ASSERT_NEAR(seen.light.flow(column, row), whole.light.flow(column + 16, row + 16), 1e-9);
      }
    }
  }
}

// The image of white paper: cos^4 of the angle to the axis.
TEST(Light, OfWhitePaperFallsWithCosFour) {
  PlannedScene const scene(build_scene(table1_setup(101)));
  Image<double> const white = render_white_light(scene);
  EXPECT_EQ(white(50, 50), 1.0);
  double const tangent = 50 * 10e-6 / 0.117318436;
  EXPECT_NEAR(white(100, 50), std::pow(1 + tangent * tangent, -2), 1e-9);
  EXPECT_NEAR(white(0, 100), std::pow(1 + 2 * tangent * tangent, -2), 1e-9);
}

// Dark dots on white paper are white minus the light of bright dots, pixel by pixel; the medium does not change the
// paper between them.
TEST(Light, OfDarkDotsIsWhitePaperLessTheDots) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(100, 50);
  PlannedScene bright = scene_with_dots(setup, {{20, 20}, {44, 30}}, 256);
  Rendering const dots = render_all(bright);
  setup.target.polarity = Polarity::dark;
  PlannedScene dark = scene_with_dots(setup, {{20, 20}, {44, 30}}, 256);
  Rendering const paper = render_all(dark);
  Image<double> const white = render_white_light(dark);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      ASSERT_EQ(paper.light.reference(column, row), white(column, row) - dots.light.reference(column, row));
      ASSERT_EQ(paper.light.flow(column, row), white(column, row) - dots.light.flow(column, row));
    }
  }
  EXPECT_EQ(paper.light.flow(10, 50), white(10, 50));
  EXPECT_LT(paper.light.reference(20, 20), 0.3);
  // the middle of a large dark dot is black
  setup.target.dot_diameter_px = 30;
  PlannedScene large = scene_with_dots(setup, {{31.5, 31.5}}, 1 << 14);
  EXPECT_NEAR(render_all(large).light.reference(31, 31), 0, 0.05);
}

}  // namespace
}  // namespace gladstone
