#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "render/base/parallel.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

template <class Range>
bool same_bits(Range const& a, Range const& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0;
}

// Images accumulate in integers, and the sums of a dot follow the order of its rays, so that no sum depends on threads.
TEST(FocusedDotsRenderer, GivesTheSameBitsOnAnyNumberOfThreads) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  PlannedScene scene(build_scene(setup));
  Rendering first;
  for (int const threads : {1, 2, 7}) {
    set_thread_count(threads);
    PlannedScene again = scene;
    plan_step(again);
    again.plan.rays = 32;
    Rendering rendering = render_all(again);
    if (threads == 1) {
      first = std::move(rendering);
      continue;
    }
    EXPECT_TRUE(same_bits(first.light.reference, rendering.light.reference)) << threads;
    EXPECT_TRUE(same_bits(first.light.flow, rendering.light.flow)) << threads;
    GroundTruth const &a = first.truth, &b = rendering.truth;
    EXPECT_TRUE(same_bits(a.reference_px, b.reference_px) && same_bits(a.displacement_px, b.displacement_px))
        << threads;
    EXPECT_TRUE(same_bits(a.displacement_std_px, b.displacement_std_px) && same_bits(a.flux, b.flux)) << threads;
    EXPECT_TRUE(same_bits(a.eq9_px, b.eq9_px) && same_bits(a.eq9_cone_px, b.eq9_cone_px)) << threads;
    EXPECT_TRUE(same_bits(a.chief_px, b.chief_px) && same_bits(a.rays, b.rays)) << threads;
    EXPECT_EQ(first.statuses, rendering.statuses) << threads;
    EXPECT_EQ(first.rays, rendering.rays) << threads;
  }
  set_thread_count(0);
}

TEST(FocusedDotsRenderer, WithoutAMediumBothFramesAreEqual) {
  auto const setup = table1_setup(48);
  PlannedScene scene = scene_with_dots(setup, lattice(48, 4, 10), 64);
  Rendering const rendering = render_all(scene);
  EXPECT_TRUE(same_bits(rendering.light.reference, rendering.light.flow));
  for (std::size_t i = 0; i < rendering.truth.size(); ++i) {
    EXPECT_EQ(rendering.truth.displacement_px[i], (Vec2d{0, 0}));
    EXPECT_EQ(rendering.truth.eq9_px[i], (Vec2d{0, 0}));
    EXPECT_EQ(rendering.truth.eq9_cone_px[i], (Vec2d{0, 0}));
  }
}

// A uniform slab displaces nothing: with matched faces at any density, with refracting ones at the ambient density. The
// interface allows 1e-11 px; the rounding of positions of 1e3 px amounts to 1e-13.
TEST(FocusedDotsRenderer, UniformDensityDisplacesNothing) {
  std::string const path = (std::filesystem::path(testing::TempDir()) / "uniform.nrrd").string();
  write_plane(path, 16, 16, [](int, int) { return 1.7; });
  FieldSetup plane;
  plane.kind = FieldKind::file;
  plane.file = path;
  plane.where = "test";
  plane.spacing = Vec3d{5e-3, 5e-3, 1e-3};
  plane.extrude = true;
  struct Case {
    FieldSetup field;
    Faces faces;
  };
  for (Case const& one : {Case{plane, Faces::matched}, Case{uniform_gradient(0, 0), Faces::matched},
                          Case{uniform_gradient(0, 0), Faces::refract}}) {
    for (Integrator const integrator : {Integrator::rk4, Integrator::euler, Integrator::straight}) {
      auto setup = table1_setup(512);
      setup.medium.field = one.field;
      setup.medium.faces = one.faces;
      setup.medium.integrator = integrator;
      PlannedScene scene = scene_with_dots(setup, lattice(512, 3, 200), 64);
      GroundTruth const truth = trace_truth(scene);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_LE(std::abs(truth.displacement_px[i].x), 1e-11);
        EXPECT_LE(std::abs(truth.displacement_px[i].y), 1e-11);
        EXPECT_LE(length(truth.eq9_cone_px[i]), 1e-11);
      }
    }
  }
}

// Without a medium and for a point in focus, every ray of every dot lands at the pinhole projection.
TEST(FocusedDotsRenderer, ReferenceIsWhereThePinholeSees) {
  auto setup = table1_setup(256);
  setup.target.dot_diameter_px = 0;
  auto const at = lattice(256, 5, 45);
  PlannedScene scene = scene_with_dots(setup, at, 64);
  GroundTruth const truth = trace_truth(scene);
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(truth.reference_px[i].x, at[i].x, 1e-9);
    EXPECT_NEAR(truth.reference_px[i].y, at[i].y, 1e-9);
  }
}

// Each dot is aimed at individually, for any deflection: behind a prism of 2.26e-4 * g * L_z, its light cone passes the
// stop at a displacement of more than half of the stop's radius, for which the initial table is too small. In a uniform
// gradient, all of its light arrives, displaced by Eq. 9 within theta^2.
TEST(FocusedDotsRenderer, AimsAgainAtStronglyDeflectedDot) {
  auto setup = table1_setup(64);
  setup.target.dot_diameter_px = 0;
  setup.medium.field = uniform_gradient(1500, -800);
  PlannedScene scene = scene_with_dots(setup, {{32, 32}}, 32);
  double const shift = 2.26e-4 * 1700 * 0.01 * 0.75;  // K g L_z Z_A
  ASSERT_GT(shift, 0.5 * scene.imaging.entrance_pupil / 2);
  Rendering const rendering =
      FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
  ASSERT_TRUE(rendering.left.empty());
  GroundTruth const& truth = rendering.truth;
  EXPECT_NEAR(truth.flux[0].y / truth.flux[0].x, 1, 1e-3);
  EXPECT_NEAR(truth.displacement_px[0].x / truth.eq9_px[0].x, 1, 1e-3);
  EXPECT_NEAR(truth.displacement_px[0].y / truth.eq9_px[0].y, 1, 1e-3);
  EXPECT_EQ(truth.rays_planned[0], 32);
}

// The result of a dot does not depend on the other dots: the table's nodes are at fixed positions, and all dots have
// the same rays.
TEST(FocusedDotsRenderer, ADotIsTheSameBitsAloneAndAmongManyOthers) {
  for (FieldSetup const& field : {dns_plane("late"), sinusoid(0.1, 4e-3)}) {
    auto setup = table1_setup(128);
    setup.medium.field = field;
    PlannedScene many = scene_with_dots(setup, lattice(128, 35, 3.6), 32);
    Rendering const all = FocusedDotsRenderer().render(many, many.plan, many.dots, RenderImages::no, RenderTheory::yes);
    ASSERT_TRUE(all.left.empty());
    for (std::size_t const dot : {0u, 1224u, 35u * 17u + 16u, 35u * 6u + 34u}) {
      PlannedScene alone = many;
      alone.dots.centre = {many.dots.centre[dot]};
      Rendering const one =
          FocusedDotsRenderer().render(alone, alone.plan, alone.dots, RenderImages::yes, RenderTheory::yes);
      EXPECT_EQ(one.truth.displacement_px[0], all.truth.displacement_px[dot]);
      EXPECT_EQ(one.truth.reference_px[0], all.truth.reference_px[dot]);
      EXPECT_EQ(one.truth.displacement_error_px[0], all.truth.displacement_error_px[dot]);
      EXPECT_EQ(one.truth.displacement_std_px[0], all.truth.displacement_std_px[dot]);
      EXPECT_EQ(one.truth.eq9_cone_px[0], all.truth.eq9_cone_px[dot]);
      EXPECT_EQ(one.truth.flux[0], all.truth.flux[dot]);
    }
  }
}

// Light is accumulated in whole units: all dots minus the others equals the one dot, to the last bit.
TEST(FocusedDotsRenderer, TheLightOfADotIsTheSameAloneAndAmongOthers) {
  auto setup = table1_setup(96);
  setup.medium.field = dns_plane("late");
  PlannedScene many = scene_with_dots(setup, lattice(96, 20, 4.3), 32), alone = many, others = many;
  std::size_t const dot = 20 * 9 + 11;
  alone.dots.centre = {many.dots.centre[dot]};
  others.dots.centre.erase(others.dots.centre.begin() + static_cast<std::ptrdiff_t>(dot));
  FramePair<double> const all = render_all(many).light, one = render_all(alone).light, rest = render_all(others).light;
  for (std::size_t i = 0; i < all.flow.size(); ++i) {
    // multiples of 1/2^n, which doubles represent without rounding
    ASSERT_EQ(all.flow.data()[i], one.flow.data()[i] + rest.flow.data()[i]);
    ASSERT_EQ(all.reference.data()[i], one.reference.data()[i] + rest.reference.data()[i]);
  }
}

// Dots whose rays miss the sensor's area have a truth like any other; a dot outside the image adds no light to it.
TEST(FocusedDotsRenderer, DotsOutsideThePictureHaveTruthButNoLight) {
  auto setup = table1_setup(64);
  setup.target.dot_diameter_px = 0;
  setup.medium.field = uniform_gradient(100, 0);
  PlannedScene scene = scene_with_dots(setup, {{-40, 32}}, 64);
  Rendering const rendering = render_all(scene);
  EXPECT_NEAR(rendering.truth.reference_px[0].x, -40, 1e-9);
  EXPECT_NEAR(rendering.truth.displacement_px[0].x, -0.66266, 0.002);
  for (double const light : rendering.light.flow) ASSERT_EQ(light, 0.0);
  auto const missed = static_cast<std::size_t>(RayStatus::missed_sensor);
  EXPECT_EQ(rendering.statuses[0][missed], rendering.truth.rays[0][0]);
  EXPECT_EQ(rendering.statuses[1][missed], rendering.truth.rays[0][1]);
}

}  // namespace
}  // namespace gladstone
