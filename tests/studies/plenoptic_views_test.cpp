#include "studies/case/plenoptic_views.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/rays/rays_renderer.h"
#include "tests/scene/planned_scene.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

constexpr double mm = 1e-3, um = 1e-6;
constexpr double pitch = 60 * um;

/// White spheres at a distance of 750 mm, imaged by 105 mm at f/4 through lenslets of 60 um. Each lenslet shows the
/// stop 60 um wide (d D / z_i = 280 * 26.25 / 122.1), 12 pixels of 5 um.
Setup plenoptic_setup(LensletLayout layout) {
  Setup setup;
  setup.camera.columns = setup.camera.rows = 600;
  setup.camera.pixel_pitch = 5 * um;
  setup.lens.f_number = 4;
  setup.z_d = 0;
  setup.elements = {LensletSetup{pitch, 280 * um, 280 * um, layout}};
  PivSetup piv;
  piv.laser.profile = SheetProfile::top_hat;
  piv.laser.thickness = 200 * mm;
  piv.particles.scattering = ParticleScattering::lambert;
  piv.particles.amount = 10;
  piv.particles.volume = Vec3d{4 * mm, 4 * mm, 1 * mm};
  setup.piv = piv;
  return setup;
}

/// Plenoptic image of particles of equal light at the given positions.
Image<double> picture(Setup const& setup, std::vector<Vec3d> const& places) {
  PlannedScene scene(build_scene(setup));
  scene.particles.resize(places.size());
  for (int pulse = 0; pulse < 2; ++pulse) {
    scene.particles.place[pulse] = places;
    scene.particles.photons[pulse].assign(places.size(), 1.0);
  }
  scene.particles.diameter.assign(places.size(), 1e-6);
  scene.photon_unit = 1;
  plan_step(scene);
  scene.plan.rays = 2048;
  return RaysRenderer()
      .render_particles(scene, scene.plan, scene.particles, ParticleLight::equal, RenderImages::yes)
      .light.reference;
}

Vec2d centroid(Image<double> const& image) {
  double sum = 0;
  Vec2d first{};
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns(); ++column) {
      sum += image(column, row);
      first += image(column, row) * Vec2d{static_cast<double>(column), static_cast<double>(row)};
    }
  }
  return first / sum;
}

/// `across` positions along each direction about the axis at the given depth, whose images are an integer number and a
/// fraction of lenslets apart: they sample the lenslets uniformly.
std::vector<Vec3d> spread_at(double z, int across, int apart, LensletLayout layout) {
  std::vector<Vec3d> places;
  double const lenslet = pitch / (105.0 / 645) * (750 * mm - z) / (750 * mm);  // images at that depth
  double const step = (apart + 1.0 / across) * lenslet;
  double const row = layout == LensletLayout::hexagonal ? std::sqrt(0.75) : 1;  // row distance over pitch
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < across; ++j) places.push_back({(i - across / 2) * step, (j - across / 2) * row * step, z});
  }
  return places;
}

class Views : public testing::TestWithParam<LensletLayout> {};

// The image of a point moves by (1 - z_i / v) s / pitch pixels from view to view, with v the image distance of the
// point. The position of a view in the stop is known to one pixel's part of the stop (a twelfth), compared with s. The
// mean over 11 x 11 points, whose images sample the lenslets uniformly, is accurate to half of an eleventh of a pixel.
// They lie within the width of one lenslet. A row of a hexagonal array is sqrt(3/4) pitch from the next one, but the
// pixels that show its light a whole pitch: away from the middle row that is an error of up to 0.13 pixels.
TEST_P(Views, ShowTheParallaxThatGeometrySays) {
  gladstone::Setup const setup = plenoptic_setup(GetParam());
  PlenopticCamera const camera = PlenopticCamera::of(setup, "test");
  EXPECT_NEAR(camera.picture_px(), 12.04, 0.01);
  double const z_i = 1 / (1 / 0.105 - 1 / 0.75);
  double const beside = GetParam() == LensletLayout::hexagonal ? 1 - std::sqrt(0.75) : 0;
  for (double const z : {25 * mm, 0.0, -30 * mm}) {
    Image<double> const raw = picture(setup, spread_at(z, 11, 0, GetParam()));
    PlenopticViews const views(camera, raw);
    Vec2d const middle = centroid(views.view({}));
    for (Vec2d const s : {Vec2d{8 * mm, 0}, Vec2d{-5 * mm, 6 * mm}, Vec2d{0, -9 * mm}}) {
      double const v = 1 / (1 / 0.105 - 1 / (750 * mm - z));
      Vec2d const moved = (1 - z_i / v) / pitch * Vec2d{-s.x, s.y};  // position in the image, inverted by the lens
      Vec2d const seen = centroid(views.view(s)) - middle;
      EXPECT_LT(length(seen - moved), 0.05 + beside + 0.03 * length(moved)) << z << ' ' << s.x << ' ' << s.y;
    }
  }
}

// Points 60 mm in front of the plane in focus are spread over parallax * D = 6.2 lenslets, some 30 pixels of an image
// focused there. Refocused on them, each covers a few pixels, and 20 mm in front of or behind them, where they are
// spread over two lenslets, more. The sum of squares over the squared sum is the inverse of the number of pixels that a
// point covers.
TEST_P(Views, AreFocusedOnAnotherPlane) {
  gladstone::Setup const setup = plenoptic_setup(GetParam());
  PlenopticCamera const camera = PlenopticCamera::of(setup, "test");
  Image<double> const raw = picture(setup, spread_at(60 * mm, 5, 5, GetParam()));
  PlenopticViews const views(camera, raw);
  std::vector<Vec2d> const stops = stop_positions(camera.stop_diameter, 9);
  auto const sharpness = [&](double z) {
    Image<double> const image = views.refocused(stops, 750 * mm - z);
    double sum = 0, squares = 0;
    for (double const level : image) {
      sum += level;
      squares += level * level;
    }
    return squares / (sum * sum);
  };
  EXPECT_GT(sharpness(60 * mm), 3 * sharpness(0));
  EXPECT_GT(sharpness(60 * mm), 1.1 * sharpness(40 * mm));
  EXPECT_GT(sharpness(60 * mm), 1.1 * sharpness(80 * mm));
}

INSTANTIATE_TEST_SUITE_P(Of, Views, testing::Values(LensletLayout::square, LensletLayout::hexagonal));

TEST(PlenopticCamera, PlacesViewsEvenlyOverTheStop) {
  std::vector<Vec2d> const places = stop_positions(30 * mm, 3);
  ASSERT_EQ(places.size(), 9u);  // the corners are at sqrt(2) / 3 of the diameter, within half of it
  EXPECT_NEAR(length(places.front() - Vec2d{-10 * mm, 10 * mm}), 0, 1e-12);
  EXPECT_NEAR(length(places[4]), 0, 1e-12);
  EXPECT_EQ(stop_positions(30 * mm, 5).size(), 21u);  // the corners of 25 views are beyond it
}

TEST(PlenopticCamera, HasLensletsAndAStop) {
  gladstone::Setup setup = plenoptic_setup(LensletLayout::square);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  EXPECT_THROW(PlenopticCamera::of(setup, "test"), DataError);
  setup = plenoptic_setup(LensletLayout::square);
  setup.elements.clear();
  EXPECT_THAT([&] { PlenopticCamera::of(setup, "case/setup.toml"); },
              ThrowsDataError(ErrorCode::unsupported, "case/setup.toml"));
}

}  // namespace
}  // namespace gladstone
