#include "render/focused_dots/focused_dots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "render/base/error.h"
#include "render/focused_dots/deflection_map.h"
#include "tests/scene/small_scenes.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

TEST(FocusedDots, AreNothingButFlatDotsInFocusOfAThinLens) {
  auto const bench = table1_setup(64);
  EXPECT_EQ(reason_against_focused_dots(bench), "");
  auto const refused = [&](auto const& change) {
    auto setup = bench;
    change(setup);
    return !reason_against_focused_dots(setup).empty();
  };
  EXPECT_TRUE(refused([](auto& s) { s.lens.prescription = std::make_shared<Lens const>(); }));
  EXPECT_TRUE(refused([](auto& s) { s.pose = Pose<double>{{0, 0, 0.75}}; }));
  EXPECT_TRUE(refused([](auto& s) { s.elements.emplace_back(OpticalWindow{}); }));
  EXPECT_TRUE(refused([](auto& s) { s.camera.tilt.x = 1e-3; }));
  EXPECT_TRUE(refused([](auto& s) { s.camera.scheimpflug = true; }));
  EXPECT_TRUE(refused([](auto& s) { s.camera.distortion.k1 = 1e-3; }));
  EXPECT_TRUE(refused([](auto& s) { s.lens.f_number = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](auto& s) { s.lens.focus = Focus::medium; }));
  EXPECT_TRUE(refused([](auto& s) { s.lens.spot = SpotModel::airy; }));
  EXPECT_TRUE(refused([](auto& s) { s.lens.spot = SpotModel::none; }));
  EXPECT_TRUE(refused([](auto& s) { s.render.sampling = PupilSampling::random; }));
}

// A table has at most 1e8 rays, of 20 bytes each: 2 GB in addition to the image.
TEST(Memory, OfATableCountsBesideImagesFieldAndDots) {
  auto setup = table1_setup(1000000);
  setup.medium.field = sinusoid(0.1, 4e-3);
  EXPECT_THAT([&] { check_memory(setup, FieldMemory::needed, focused_dots_memory(setup)); },
              ThrowsDataError(ErrorCode::memory, "",
                              testing::HasSubstr(focused_dots_memory(setup).front().what + std::string(" 2)"))));
}

// The estimated size of a table counts nodes by area; the table itself has integer numbers of rows and columns, up to
// two more. If the number of rays is automatic, the finer table is assumed.
TEST(Memory, OfATableIsKnownFromItsSetup) {
  for (FieldSetup const& field : {dns_plane("late"), sinusoid(0.1, 2e-3)}) {
    auto setup = table1_setup(256);
    setup.medium.field = field;
    PlannedScene scene(build_scene(setup));
    for (int const fineness : {1, 2}) {
      setup.render.rays_per_dot.reset();
      if (fineness == 1) setup.render.rays_per_dot = 32;
      scene.plan.fineness = fineness;
      DeflectionTableLayout const plan(build_focused_dots(scene, scene.plan).value(), scene.dots, 0);
      ASSERT_TRUE(plan.wanted());
      EXPECT_NEAR(table_bytes_needed(setup) / static_cast<double>(plan.table.bytes()), 1, 0.1) << fineness;
    }
  }
  auto setup = table1_setup(256);
  EXPECT_EQ(table_bytes_needed(setup), 0);
  setup.medium.field = sinusoid(0.1, 2e-3);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  EXPECT_EQ(table_bytes_needed(setup), 0);
}

}  // namespace
}  // namespace gladstone
