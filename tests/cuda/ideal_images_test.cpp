#include "render/ideal_images/ideal_images.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/render.h"
#include "tests/cuda/cuda_renderer_fixture.h"
#include "tests/support/ideal_pairs.h"

namespace gladstone {
namespace {

/// Pairs of 150 x 100 px of the given pitch with a uniform flow.
BosSetup pair_setup(double pitch = 5e-6, ParticleScattering scattering = ParticleScattering::gaussian) {
  BosSetup setup = test::pair_setup(scattering, 150, 100);
  setup.render.method = RenderMethod::formula;
  setup.camera.pixel_pitch = pitch;
  setup.piv->particles.volume = Vec3d{6e-3, 5e-3, 1e-3};
  setup.piv->flow.flow.uniform = {10, -4, 1};
  return setup;
}

class CudaIdealImagesTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!cuda::device_state().usable) GTEST_SKIP() << cuda::device_state().text;
  }

  /// Renders the scene of a setup on both devices; light and truth must be equal to the last bit.
  void expect_same_bits(BosSetup const& setup) {
    Scene const scene = build_scene(setup);
    Device on_cpu = cpu(), on_gpu(cuda::make_renderer(), cuda::make_rays_renderer(), cuda::make_image_drawer());
    Rendering const a = render(scene, on_cpu), b = render(scene, on_gpu);
    EXPECT_EQ(a.device, "cpu");
    EXPECT_EQ(b.device, "cuda");
    EXPECT_TRUE(same_bits(a.light.reference, b.light.reference));
    EXPECT_TRUE(same_bits(a.light.flow, b.light.flow));
    EXPECT_EQ(a.truth.flux, b.truth.flux);
    Rendering const stays = render(scene, on_gpu, RenderImages::in_place);
    EXPECT_TRUE(same_bits(a.light.flow, stays.in_place->to_host().flow));
  }
};

// Pixels add up the images in the same order by the same fused operations. PSFs with a standard deviation of 0.8, 1.7,
// 3.5 and 8 px, hence with footprints of 11, 21, 41 and 91 px: narrower and wider than a tile.
TEST_F(CudaIdealImagesTest, HaveTheBitsOfTheCpu) {
  for (double const pitch : {5e-6, 2.4e-6, 1.2e-6, 0.52e-6}) {
    SCOPED_TRACE(pitch);
    expect_same_bits(pair_setup(pitch));
  }
}

// Images of scattered light have different widths, here up to 1.3 times that of the PSF.
TEST_F(CudaIdealImagesTest, HaveTheBitsOfTheCpuOutOfFocus) {
  for (auto const scattering : {ParticleScattering::lambert, ParticleScattering::mie}) {
    BosSetup setup = pair_setup(5e-6, scattering);
    setup.lens.f_number = 5.6;
    expect_same_bits(setup);
  }
}

// 5 particles per pixel: the lists of the tiles become longer than their first capacity.
TEST_F(CudaIdealImagesTest, GrowTheirLists) {
  BosSetup setup = pair_setup();
  setup.piv->particles.amount = 5;
  expect_same_bits(setup);
}

template <class Level>
std::vector<Level> on_host(PairBatchRenderer const& renderer, DeviceBuffer const& buffer, std::size_t count) {
  std::vector<Level> levels(count);
  renderer.copy_to_host(levels.data(), buffer, count * sizeof(Level));
  return levels;
}

/// Returns the frames of a pair that the CPU renders and records, one after the other.
std::vector<std::uint16_t> recorded_on_cpu(BosSetup setup, PairSeeds seeds) {
  setup.piv->particles.seed = seeds.particles;
  setup.camera.noise.seed = seeds.noise;
  Scene const scene = build_scene(setup);
  Device device = cpu();
  Rendering const rendering = render(scene, device, RenderImages::in_place);
  ExposureRule const rule = build_pair_model(setup).model.exposure;
  Detector const detector(setup.camera, rule.electrons(rendering.in_place->brightest(), scene.photon_unit));
  RecordedFrames const frames = rendering.in_place->record(detector);
  std::vector<std::uint16_t> levels;
  for (Image<double> const* frame : {&frames.levels->reference(), &frames.levels->flow()}) {
    for (double const level : *frame) levels.push_back(static_cast<std::uint16_t>(level));
  }
  return levels;
}

// Particles that the device seeds differ from those of the CPU by rounding, 1e-13 of their light and position. A grey
// level differs only if it is that close to the edge of a level, which has a probability of 1e-9 per pixel.
TEST_F(CudaIdealImagesTest, BatchesHaveTheGreyLevelsOfTheCpu) {
  for (bool const noisy : {false, true}) {
    for (int const kind : {0, 1, 2, 3}) {
      BosSetup setup = pair_setup(5e-6, kind == 3 ? ParticleScattering::lambert : ParticleScattering::gaussian);
      setup.camera.noise.enabled = noisy;
      if (kind == 1) setup.piv->flow.flow.kind = TaylorGreenFlow{20, 2e3, {}};
      if (kind == 1) setup.piv->particles.diameter = {DiameterSpread::lognormal, 1e-6, 0.3, ""};
      if (kind == 2) setup.piv->flow.flow.kind = LambOseenFlow{PlaneVortex{0.05, 1e-3, {}}};
      if (kind == 2) setup.piv->particles.density = 2000;
      std::vector<PairSeeds> const seeds{{3, 5}, {4, 6}, {1000, 7}};
      auto const batches = cuda::make_pair_batches({build_pair_model(setup)});
      std::size_t const pair = 2u * 150 * 100, count = seeds.size() * pair;
      auto const levels = on_host<std::uint16_t>(*batches, batches->render(seeds, LevelType::uint16), count);
      auto const shares = on_host<float>(*batches, batches->render(seeds, LevelType::float32), count);
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        std::vector<std::uint16_t> const expected = recorded_on_cpu(setup, seeds[i]);
        ASSERT_EQ(expected.size(), pair);
        EXPECT_TRUE(std::equal(expected.begin(), expected.end(), levels.begin() + static_cast<long>(i * pair)))
            << "pair " << i << ", kind " << kind << ", noise " << noisy;
      }
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(shares[i], static_cast<float>(levels[i] / 4095.0));
    }
  }
}

// Pairs of different setups in one batch are those of each setup alone; levels of 8 bits are bytes.
TEST_F(CudaIdealImagesTest, BatchesMixSetups) {
  BosSetup first = pair_setup(), second = pair_setup();
  first.camera.bit_depth = second.camera.bit_depth = 8;
  second.piv->flow.flow.kind = ShearFlow{3e3, {}};
  second.piv->particles.amount = 0.02;
  auto const mixed = cuda::make_pair_batches({build_pair_model(first), build_pair_model(second)});
  std::size_t const pair = 2u * 150 * 100;
  auto const both = on_host<std::uint8_t>(*mixed, mixed->render({{1, 1}, {2, 2}}, LevelType::uint8), 2 * pair);
  auto const single = cuda::make_pair_batches({build_pair_model(second)});
  auto const alone = on_host<std::uint8_t>(*single, single->render({{2, 2}}, LevelType::uint8), pair);
  EXPECT_TRUE(std::equal(alone.begin(), alone.end(), both.begin() + static_cast<long>(pair)));
}

// The tables of Mie scattering for particles of different seeds have different nodes, and an error of 1e-5 of the
// light. At 12 bits this is less than a tenth of a level.
TEST_F(CudaIdealImagesTest, BatchesHaveTheMieScatteringOfTheCpu) {
  BosSetup const setup = pair_setup(5e-6, ParticleScattering::mie);
  auto const batches = cuda::make_pair_batches({build_pair_model(setup)});
  std::size_t const pair = 2u * 150 * 100;
  auto const levels = on_host<std::uint16_t>(*batches, batches->render({{3, 5}}, LevelType::uint16), pair);
  std::vector<std::uint16_t> const expected = recorded_on_cpu(setup, {3, 5});
  for (std::size_t i = 0; i < pair; ++i) ASSERT_NEAR(levels[i], expected[i], 1) << i;
  EXPECT_GT(*std::max_element(levels.begin(), levels.end()), 3000);
}

// Displacements are single-precision numbers of up to 10 px, whose rounding is 5e-7 px.
TEST_F(CudaIdealImagesTest, BatchesHaveTheDisplacementOfEveryPixel) {
  BosSetup setup = pair_setup();
  setup.piv->flow.flow.kind = TaylorGreenFlow{20, 2e3, {}};
  OwnedPairModel const owned = build_pair_model(setup);
  auto const batches = cuda::make_pair_batches({owned});
  auto const moved = on_host<float>(*batches, batches->displacement(), 2u * 150 * 100);
  for (int const row : {0, 41, 99}) {
    for (int column = 0; column < 150; ++column) {
      Vec2d const expected = owned.model.displacement({static_cast<double>(column), static_cast<double>(row)});
      std::size_t const at = static_cast<std::size_t>(row) * 150 + static_cast<std::size_t>(column);
      EXPECT_NEAR(moved[at], expected.x, 2e-6);
      EXPECT_NEAR(moved[150 * 100 + at], expected.y, 2e-6);
    }
  }
}

}  // namespace
}  // namespace gladstone
