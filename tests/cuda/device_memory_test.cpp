#include "cuda/device/device_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "cuda/backend.h"
#include "cuda/focused_dots/dot_cones.h"
#include "render/base/error.h"
#include "render/focused_dots/deflection_map.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/cuda/memory_limits.h"
#include "tests/scene/small_scenes.h"
#include "tests/support/contains_whole.h"
#include "tests/support/numbers_in.h"

namespace gladstone::cuda {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t mebibyte = std::size_t{1} << 20;

/// Behaviour on a device with little memory: first smaller batches, then an error that states the sizes.
class SmallDevice : public ::testing::Test {
 protected:
  void SetUp() override {
    if (DeviceState const state = device_state(); !state.usable) GTEST_SKIP() << state.text;
    renderer_ = make_renderer();
  }
  Rendering render(PlannedScene& scene) const {
    return renderer_->render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
  }
  std::unique_ptr<Renderer> renderer_;
};

PlannedScene scene_of(FieldSetup const& field, int dots_a_side, std::uint64_t rays) {
  gladstone::Setup setup = table1_setup(96);
  setup.medium.field = field;
  return scene_with_dots(setup, lattice(96, dots_a_side, 14), rays);
}

/// The volume of benchmark case P: 64^3 floats, slightly more than 1 MiB.
FieldSetup volume() {
  FieldSetup field;
  field.kind = FieldKind::file;
  field.file = std::string(GLADSTONE_DATA_DIR) + "/benchmarks/case_p_volume.nrrd";
  field.where = "test";
  field.quantity = FieldQuantity::refractivity;
  double const cell = 32.7e-3 / 63;
  field.spacing = Vec3d{cell, cell, cell};
  return field;
}

/// Returns the message about the memory that a work lacks; "no error" if it succeeds.
std::string error_of(std::function<void()> const& work) {
  try {
    work();
  } catch (DeviceMemoryError const& error) {
    return error.what();
  }
  return "no error";
}

void expect_same(Rendering const& a, Rendering const& b) {
  EXPECT_TRUE(std::equal(a.light.reference.begin(), a.light.reference.end(), b.light.reference.begin()));
  EXPECT_TRUE(std::equal(a.light.flow.begin(), a.light.flow.end(), b.light.flow.begin()));
  EXPECT_EQ(a.truth.displacement_px, b.truth.displacement_px);
  EXPECT_EQ(a.truth.eq9_cone_px, b.truth.eq9_cone_px);
  EXPECT_EQ(a.statuses, b.statuses);
}

TEST_F(SmallDevice, RendersTheSameBitsInSmallerBatches) {
  constexpr std::uint64_t rays = 64;
  constexpr std::size_t dot_bytes = sizeof(DotCone);
  for (FieldSetup const& field : {dns_plane("kepeak"), volume()}) {
    PlannedScene scene = scene_of(field, 6, rays);
    render(scene);  // uploads the field, which remains on the device
    auto const with_limit = [&](std::size_t bytes, std::size_t& most) {
      DeviceMemoryLimit const limit(bytes);
      Rendering rendering = render(scene);
      most = limit.most_held();
      return rendering;
    };
    std::size_t whole = 0, parts = 0;
    Rendering const expected = with_limit(DeviceMemoryLimit::none, whole);
    ASSERT_GT(whole, 36 * dot_bytes) << "all 36 dots are processed at a time";
    // memory for slightly more than 6 dots: halving batches of 36 dots ends at batches of 4
    std::size_t const room = whole - 30 * dot_bytes;
    Rendering const rendering = with_limit(room, parts);
    EXPECT_LE(parts, room);
    expect_same(expected, rendering);
  }
}

// The device stores only sums over the rays of a dot, one DotCone per dot: a million rays of one dot need only the
// memory of the images and of the points of a few cones, whereas records of 64 bytes per ray would exceed the limit.
TEST_F(SmallDevice, TracesAMillionRaysOfADotInTheMemoryOfAFew) {
  PlannedScene scene = scene_of(uniform_gradient(20, -8), 1, mebibyte);
  DeviceMemoryLimit const limit(64 * mebibyte);
  EXPECT_EQ(render(scene).truth.size(), 1u);
  EXPECT_LT(limit.most_held(), 64 * mebibyte);
}

// A warp accumulates light in squares of up to 56 x 56 px if the shared memory of a block is large enough, which is not
// the case on every device. The sums are integers, so that a pixel does not depend on the accumulation.
TEST_F(SmallDevice, GathersTheSameLightWithLessSharedMemory) {
  gladstone::Setup setup = table1_setup(96);
  setup.target.dot_diameter_px = 30;
  std::vector<PlannedScene> scenes{scene_of(dns_plane("kepeak"), 8, 32)};
  for (FieldSetup const& field : {FieldSetup{}, uniform_gradient(20, -8)}) {
    setup.medium.field = field;
    scenes.push_back(scene_with_dots(setup, lattice(96, 3, 33), 200));
  }
  for (PlannedScene& scene : scenes) {
    Rendering const expected = render(scene);
    for (std::size_t const kibibytes : {99, 64, 40, 24}) {
      SharedMemoryLimit const limit(kibibytes << 10);
      expect_same(expected, render(scene));
    }
  }
}

TEST_F(SmallDevice, NamesTheSizeOfATableThatDoesNotFit) {
  PlannedScene scene = scene_of(dns_plane("kepeak"), 8, 32), few = scene;
  few.dots.centre.resize(4);
  FocusedDots const dots = build_focused_dots(scene, scene.plan).value();
  double const default_aim_distance = DeflectionTableLayout::default_aim_distance(scene.imaging);
  DeflectionTableLayout const plan(dots, scene.dots, default_aim_distance);
  DeflectionTableLayout const of_few(build_focused_dots(few, few.plan).value(), few.dots, default_aim_distance);
  ASSERT_TRUE(plan.wanted() && of_few.wanted());
  // uploads the field, which remains on the device, and a table, which is released before the next one is allocated
  render(few);
  {
    DeviceMemoryLimit const limit(plan.table.bytes() - of_few.table.bytes() - 1);
    char size[32];
    std::snprintf(size, sizeof size, "%.3f", static_cast<double>(plan.table.bytes()) / 0x1p20);
    EXPECT_THAT(error_of([&] { render(scene); }),
                ::testing::AllOf(HasSubstr("deflection table"), ContainsWhole(std::string(size) + " MiB")));
    EXPECT_LT(limit.most_held(), plan.table.bytes());
  }
  EXPECT_EQ(render(scene).truth.size(), 64u);
}

// In caustics, each of 400 blocks stores the points of a cone, at least 1024 of 32 bytes at each of 7 positions on a
// dot. With half the memory, half as many blocks run at a time.
TEST_F(SmallDevice, LaysDownWideConesInFewerBlocks) {
  FieldSetup field = dns_plane("kepeak");
  field.scale = 4 * field.scale.value_or(1);
  gladstone::Setup setup = table1_setup(96);
  setup.medium.field = field;
  PlannedScene scene = scene_with_dots(setup, lattice(96, 20, 4.3), 64);
  render(scene);  // uploads field and table, which remain on the device
  auto const with_limit = [&](std::size_t bytes, std::size_t& most) {
    DeviceMemoryLimit const limit(bytes);
    Rendering rendering = render(scene);
    most = limit.most_held();
    return rendering;
  };
  std::size_t const half_the_points = std::size_t{200} * 7 * 1024 * 32;
  std::size_t whole = 0, parts = 0;
  Rendering const expected = with_limit(DeviceMemoryLimit::none, whole);
  ASSERT_GT(whole, 2 * half_the_points);
  Rendering const rendering = with_limit(whole - half_the_points, parts);
  EXPECT_LE(parts, whole - half_the_points);
  expect_same(expected, rendering);
}

// A volume whose polynomials would need more than a quarter of the device's memory is traced by its coefficients, with
// the same results.
TEST_F(SmallDevice, TracesAVolumeByItsCoefficientsWherePolynomialsAreTooLarge) {
  PlannedScene scene = scene_of(volume(), 6, 64);
  std::size_t with_polynomials = 0;
  auto const render_anew = [&](std::size_t bytes, std::size_t& most) {
    DeviceMemoryLimit const limit(bytes);
    Rendering rendering = make_renderer()->render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
    most = limit.most_held();
    return rendering;
  };
  Rendering const expected = render_anew(DeviceMemoryLimit::none, with_polynomials);
  std::size_t without = 0;
  Rendering const rendering = render_anew(2 * with_polynomials, without);
  EXPECT_LT(without, with_polynomials / 4);
  for (std::size_t i = 0; i < scene.dots.centre.size(); ++i) {
    EXPECT_LT(length(rendering.truth.displacement_px[i] - expected.truth.displacement_px[i]), 1e-9) << i;
  }
}

TEST_F(SmallDevice, RefusesAVolumeThatIsLargerThanItBeforeAnyAllocation) {
  PlannedScene before = scene_of(sinusoid(0.1, 6e-3), 3, 64), large = scene_of(volume(), 3, 64);
  {
    DeviceMemoryLimit const limit(mebibyte);
    std::string const error =
        error_of([&] { make_renderer()->render(large, large.plan, large.dots, RenderImages::yes, RenderTheory::no); });
    EXPECT_THAT(error, HasSubstr("refractivity"));
    std::vector<double> const needed_free_total = numbers_in(error);
    ASSERT_EQ(needed_free_total.size(), 3u) << error;
    EXPECT_TRUE(needed_free_total[0] >= 1.0 && needed_free_total[0] < 2.0) << error;
    EXPECT_EQ(needed_free_total[1], 1.0) << error;
    EXPECT_EQ(needed_free_total[2], 1.0) << error;
    EXPECT_EQ(limit.most_held(), 0u);
  }
  // results after the error equal those before it
  Rendering const expected = render(before);
  {
    DeviceMemoryLimit const limit(0);
    EXPECT_THAT(error_of([&] { render(large); }), HasSubstr("refractivity"));
  }
  expect_same(expected, render(before));
}

ParticlePair particles(int columns, int rows) {
  ParticleSettings settings;
  settings.columns = columns;
  settings.rows = rows;
  return render_particle_pair(settings, [](Vec2d p) { return Vec2d{1.7, 0.02 * p.x}; });
}

void expect_same(DisplacementField const& a, DisplacementField const& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.status[i], b.status[i]) << i;
    if (a.counts(i)) {
      EXPECT_EQ(a.displacement_px[i], b.displacement_px[i]) << i;
    }
  }
}

// The error may occur in any of the allocations.
TEST_F(SmallDevice, RefusesACorrelationThatDoesNotFitAndThenGoesOn) {
  ParticlePair const pair = particles(256, 256);
  auto const field_of = [&](Correlator const& correlator) { return correlator.correlate(pair.reference, pair.flow); };
  std::size_t most = 0;
  DisplacementField const expected = [&] {
    DeviceMemoryLimit const limit(DeviceMemoryLimit::none);
    DisplacementField field = field_of(*cuda::make_correlator({}));
    most = limit.most_held();
    return field;
  }();
  for (std::size_t part = 0; part < 16; ++part) {
    SCOPED_TRACE(part);
    auto const correlator = [&] {
      DeviceMemoryLimit const limit(most * part / 16);
      auto made = cuda::make_correlator({});
      EXPECT_THAT(error_of([&] { field_of(*made); }), HasSubstr("correlation"));
      return made;
    }();
    expect_same(expected, field_of(*correlator));
  }
}

// Windows of 94 px have supports of 188 px and need 2 * 189 * 188 floats each in device memory: fewer of them are
// processed at a time.
TEST_F(SmallDevice, CorrelatesFewerLargeWindowsAtATime) {
  ParticlePair const pair = particles(300, 260);
  CorrelationSettings settings;
  settings.window_px = {94};
  auto const with_limit = [&](std::size_t bytes, std::size_t& most) {
    DeviceMemoryLimit const limit(bytes);
    DisplacementField field = cuda::make_correlator(settings)->correlate(pair.reference, pair.flow);
    most = limit.most_held();
    return field;
  };
  std::size_t whole = 0, parts = 0;
  DisplacementField const expected = with_limit(DeviceMemoryLimit::none, whole);
  std::size_t const room = whole - 2 * (2 * 189 * 188 * sizeof(float));
  DisplacementField const field = with_limit(room, parts);
  EXPECT_LE(parts, room);
  expect_same(expected, field);
}

// A support of 128 px (windows of 64 px) is in shared memory if it fits, else in device memory; one of 800 px has fewer
// warps, whose float sums have another order.
TEST_F(SmallDevice, CorrelatesWithLessSharedMemory) {
  ParticlePair const pair = particles(420, 410);
  for (int const window : {64, 400}) {
    CorrelationSettings settings;
    settings.window_px = {window};
    auto const correlate = [&] { return cuda::make_correlator(settings)->correlate(pair.reference, pair.flow); };
    DisplacementField const expected = correlate();
    SharedMemoryLimit const limit(std::size_t{99} << 10);
    DisplacementField const field = correlate();
    if (window == 64) {
      expect_same(expected, field);
      continue;
    }
    ASSERT_EQ(expected.size(), field.size());
    for (std::size_t i = 0; i < field.size(); ++i) {
      ASSERT_EQ(expected.status[i], field.status[i]);
      if (field.counts(i)) {
        EXPECT_LT(length(expected.displacement_px[i] - field.displacement_px[i]), 1e-4);
      }
    }
  }
}

}  // namespace
}  // namespace gladstone::cuda
