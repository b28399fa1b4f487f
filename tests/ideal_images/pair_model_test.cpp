#include "render/ideal_images/pair_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/ideal_images/ideal_images.h"
#include "render/scene/light_through_lens.h"
#include "tests/support/edge_integral.h"
#include "tests/support/expect_error.h"
#include "tests/support/ideal_pairs.h"

namespace gladstone {
namespace {

using PivScene = Scene;

/// Pairs of 96 x 80 px of 500 particles with a uniform flow.
gladstone::Setup small_pair() {
  gladstone::Setup setup = test::pair_setup(ParticleScattering::gaussian, 96, 80);
  setup.piv->particles.count = ParticleCount::number;
  setup.piv->particles.amount = 500;
  setup.piv->particles.volume = Vec3d{4e-3, 3e-3, 1e-3};
  setup.piv->flow.flow.uniform = {10, -4, 1};
  return setup;
}

/// Setups with every property that a particle's image depends on.
std::vector<gladstone::Setup> all_kinds() {
  std::vector<gladstone::Setup> setups(6, small_pair());
  setups[1].piv->flow.flow.kind = TaylorGreenFlow{20, 2e3, {1e-4, 2e-4, 0}};
  setups[1].piv->particles.diameter.spread = DiameterSpread::lognormal;
  setups[1].piv->particles.diameter.width = 0.3;
  setups[2].piv->flow.flow.kind = LambOseenFlow{PlaneVortex{0.05, 1e-3, {}}};
  setups[2].piv->particles.density = 2000;
  setups[2].piv->particles.diameter.spread = DiameterSpread::normal;
  setups[2].piv->particles.diameter.width = 4e-7;
  setups[3].piv->flow.flow.kind = ShearFlow{3e3, {}};
  setups[3].piv->laser.tilt = {0.1, -0.2};
  setups[3].piv->laser.divergence = 0.1;
  setups[3].piv->laser.profile = SheetProfile::top_hat;
  setups[4].piv->particles.scattering = ParticleScattering::lambert;
  setups[4].piv->particles.diameter.spread = DiameterSpread::lognormal;
  setups[4].piv->particles.diameter.width = 0.3;
  setups[5].piv->particles.scattering = ParticleScattering::mie;
  return setups;
}

// A particle's images follow from seed and index alone: they are those that the scene's particles have, in order, if
// the particles without light are left out. Both evaluate the same formulas, so they differ by rounding only: a few
// units in the last place of 100 px, and of the light. Tables of Mie scattering for particles of different seeds have
// different nodes, and an error of 1e-6 to 1e-5.
TEST(PairModel, MakesTheImagesOfTheScene) {
  for (gladstone::Setup setup : all_kinds()) {
    OwnedPairModel const owned = build_pair_model(setup);
    PairModel const& model = owned.model;
    bool const mie = setup.piv->particles.scattering == ParticleScattering::mie;
    double const rounding = mie ? 1e-5 : 1e-13;
    setup.piv->particles.seed = 77;
    PivScene const scene = build_scene(setup);
    auto const ideal = build_ideal_images(scene).value();
    double brightest = 0;
    std::size_t lit = 0;
    for (std::uint64_t i = 0; i < model.seeded; ++i) {
      ParticleImage image[2];
      model.images(77, i, image);
      if (!(image[0].light > 0 || image[1].light > 0)) continue;
      ASSERT_LT(lit, scene.particles.size());
      for (int pulse = 0; pulse < 2; ++pulse) {
        brightest = std::max(brightest, image[pulse].light);
        bool const illuminated = scene.particles.photons[pulse][lit] > 0;
        ASSERT_EQ(image[pulse].light > 0, illuminated);
        if (!illuminated) continue;
        double const photons = photons_through_lens(scene, lit, pulse);
        EXPECT_NEAR(image[pulse].light, photons, rounding * photons);
        EXPECT_EQ(image[pulse].sigma, ideal.blur().width(scene.particles.place[pulse][lit].z));
        EXPECT_LT(length(image[pulse].at - ideal.project(scene.particles.place[pulse][lit])), 1e-11);
      }
      ++lit;
    }
    EXPECT_EQ(lit, scene.particles.size());
    EXPECT_GT(lit, 300u);
    EXPECT_NEAR(brightest, scene.photon_unit, rounding * brightest);
  }
}

// The device computes the light of a pixel as the sum of the contributions of all images, in the order of the images
// and by fused operations. This sum equals the light of an image drawn row by row, to the bit.
TEST(PairModel, SumOverImagesEqualsDrawingByRows) {
  for (double const pitch : {5e-6, 1.2e-6}) {
    gladstone::Setup setup = small_pair();
    setup.camera.pixel_pitch = pitch;
    PivScene const scene = build_scene(setup);
    Rendering const drawn = render_ideal_images(build_ideal_images(scene).value(), scene.particles,
                                                ParticleLight::scattered, RenderImages::yes);
    GaussianSpot<double> const spot{scene.spot_sigma_px()};
    std::size_t equal = 0;
    for (int row = 0; row < setup.camera.rows; ++row) {
      for (int column = 0; column < setup.camera.columns; ++column) {
        double sum = 0;
        for (std::size_t i = 0; i < scene.particles.size(); ++i) {
          double const light = drawn.truth.flux[i].x / scene.photon_unit;
          if (!(light > 0)) continue;
          Vec2d const at = drawn.truth.reference_px[i];
          Footprint const print = spot.footprint(at);
          int const x = column - print.column, y = row - print.row;
          if (x < 0 || y < 0 || x >= print.width || y >= print.width) continue;
          double const across =
              edge_integral(spot, at.x, print.column, x + 1) - edge_integral(spot, at.x, print.column, x);
          double const down = edge_integral(spot, at.y, print.row, y + 1) - edge_integral(spot, at.y, print.row, y);
          sum = std::fma(light * down, across, sum);
        }
        equal += sum == drawn.light.reference(column, row) ? 1 : 0;
      }
    }
    EXPECT_EQ(equal, drawn.light.reference.size());
  }
}

// Uniform flow: every particle moves by scale u dt, and one that moves along the axis shifts its image by the change of
// the scale besides. Shear: the particle at height y moves by rate y dt, and has moved by half of that in frame A,
// which does not change its height.
TEST(PairModel, KnowsTheDisplacementOfEveryPixel) {
  gladstone::Setup setup = small_pair();
  double const distance = 1 / (1 / 0.105 - 1 / 0.75), scale = distance / 0.75 / 5e-6;
  setup.piv->flow.flow.uniform = {10, -4, 0};
  PairModel const uniform = build_pair_model(setup).model;
  Vec2d const moved = uniform.displacement({11.0, 70.0});
  EXPECT_NEAR(moved.x, scale * 1e-4, 1e-9);
  EXPECT_NEAR(moved.y, scale * 4e-5, 1e-9);
  setup.piv->flow.flow.uniform = {};
  setup.piv->flow.flow.kind = ShearFlow{5e3, {}};
  PairModel const shear = build_pair_model(setup).model;
  for (double const row : {0.0, 33.0, 79.0}) {
    EXPECT_NEAR(shear.displacement({50.0, row}).x, 5e3 * 1e-5 * (39.5 - row), 1e-8);
    EXPECT_NEAR(shear.displacement({50.0, row}).y, 0, 1e-9);
  }
  // Strain: a particle at x0 at mid-time is at x0 e^(-a dt/2) in frame A and at x0 e^(a dt/2) in frame B.
  setup.piv->flow.flow.kind = StagnationFlow{2e4, {}};
  PairModel const strain = build_pair_model(setup).model;
  EXPECT_NEAR(strain.displacement({80.0, 10.0}).x, 32.5 * std::expm1(0.2), 1e-4);
  EXPECT_NEAR(strain.displacement({80.0, 10.0}).y, -29.5 * std::expm1(-0.2), 1e-4);
}

TEST(PairModel, ChoosesTheExposureOfTheScene) {
  gladstone::Setup setup = small_pair();
  setup.camera.noise.enabled = true;
  ExposureRule rule = build_pair_model(setup).model.exposure;
  EXPECT_EQ(rule.electrons(0.5, 1e9), Detector::auto_exposure(setup.camera, 0.5));
  EXPECT_EQ(rule.electrons(0.5, 100), 100 * setup.camera.noise.quantum_efficiency);
  EXPECT_EQ(rule.electrons(0, 1e9), Detector::auto_exposure(setup.camera, 0));
  setup.camera.exposure_e = 1234;
  EXPECT_EQ(build_pair_model(setup).model.exposure.electrons(0.5, 1e9), 1234);
  setup.camera.absolute_exposure = true;
  EXPECT_EQ(build_pair_model(setup).model.exposure.electrons(0.5, 50), 50 * setup.camera.noise.quantum_efficiency);
}

TEST(PairModel, SaysWhyASetupHasNone) {
  gladstone::Setup setup = small_pair();
  EXPECT_EQ(reason_against_pair_model(setup), "");
  for (auto const scattering : {ParticleScattering::mie, ParticleScattering::lambert}) {
    setup = small_pair();
    setup.piv->particles.scattering = scattering;
    EXPECT_EQ(reason_against_pair_model(setup), "");
    setup.render.method = RenderMethod::formula;
    EXPECT_EQ(reason_against_pair_model(setup), "");
    setup.render.method = RenderMethod::rays;
    EXPECT_NE(reason_against_pair_model(setup), "");
  }
  setup = small_pair();
  setup.piv->particles.scattering = ParticleScattering::mie;
  setup.piv->particles.diameter.spread = DiameterSpread::lognormal;
  EXPECT_NE(reason_against_pair_model(setup), "");
  EXPECT_THAT([&] { build_pair_model(setup); }, ThrowsDataError(ErrorCode::unsupported, "particles.scattering"));
  setup = small_pair();
  setup.piv->particles.count = ParticleCount::file;
  EXPECT_NE(reason_against_pair_model(setup), "");
  setup = small_pair();
  setup.piv->flow.flow.kind = NormalShockFlow{};
  EXPECT_NE(reason_against_pair_model(setup), "");
}

// The error (r / (2 sigma))^4 / 3, weighted by exp(-8 z^2 / w^2) in a Gaussian sheet of thickness w, is largest at z =
// w/2, with a weight of exp(-2). It is half a level of 12 bits if r / (2 sigma) = (3 e^2 / 8190)^(1/4) there. r is
// inversely proportional to the f-number N and sigma proportional to it, so that the error increases as N^-8: by 17 %
// for 2 %.
TEST(PairModel, RefusesLargeBlur) {
  gladstone::Setup setup = small_pair();
  setup.piv->particles.scattering = ParticleScattering::lambert;
  setup.piv->particles.volume = Vec3d{4e-3, 3e-3, 2e-3};
  double const m = 105.0 / 645, limit = std::pow(3 * std::exp(2.0) / 8190, 0.25);
  double const reach = m * 0.105 / 2 * 0.5e-3 / (0.75 - 0.5e-3), spread = 0.4206042622 * (1 + m) * 532e-9;
  double const n = std::sqrt(reach / (2 * limit * spread));
  setup.lens.f_number = 1.02 * n;
  EXPECT_EQ(reason_against_pair_model(setup), "");
  setup.lens.f_number = 0.98 * n;
  EXPECT_NE(reason_against_pair_model(setup), "");
  setup.piv->particles.scattering = ParticleScattering::gaussian;
  EXPECT_EQ(reason_against_pair_model(setup), "");
}

}  // namespace
}  // namespace gladstone
