#include "render/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/planning.h"
#include "tests/scene/piv_setups.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

// A scene is rendered with the rooms of render/ alone. Its wave is weak: small-angle theory (Eq. 9) differs by the
// square of the displacements, by 4e-3 px at 2.5 times the amplitude and thus by 7e-4 px here; truth by rays adds 1e-3
// px.
TEST(Render, ChoosesStepAndMethodOfAScene) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.02, 4e-3);
  setup.render.rays_per_dot = 32;
  Scene const scene = build_scene(setup);
  Device device = cpu();
  Rendering const rendering = render(scene, device);
  EXPECT_EQ(rendering.plan.method, RenderMethod::focused_dots);
  EXPECT_EQ(rendering.device, "cpu");
  // The accuracy is reported: with 32 rays, the error of the table in such a smooth field is within the goals.
  ASSERT_TRUE(rendering.accuracy && rendering.accuracy->table);
  EXPECT_LE(rendering.accuracy->table->excess(), 1);
  EXPECT_LT(rendering.accuracy->truth.rms_px, truth_tolerance_px);
  EXPECT_TRUE(std::isnan(rendering.accuracy->image_levels)) << "no dot is traced by rays alone";
  EXPECT_GT(rendering.rays, 0);
  ASSERT_EQ(rendering.truth.size(), scene.dots.centre.size());
  double largest = 0;
  for (std::size_t i = 0; i < rendering.truth.size(); ++i) {
    largest = std::max(largest, length(rendering.truth.displacement_px[i]));
    EXPECT_LT(length(rendering.truth.displacement_px[i] - rendering.truth.eq9_cone_px[i]), 2e-3) << i;
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_EQ(rendering.light.reference.columns(), 64);
  EXPECT_FALSE(
      std::equal(rendering.light.reference.begin(), rendering.light.reference.end(), rendering.light.flow.begin()));

  // the same, by a plan made before
  RenderPlan const plan = plan_rendering(scene);
  EXPECT_EQ(plan.step, rendering.plan.step);
  EXPECT_EQ(plan.rays, 32u);
  Rendering const again = render(scene, plan, device, RenderImages::no, RenderTheory::no);
  EXPECT_EQ(again.truth.displacement_px, rendering.truth.displacement_px);
  EXPECT_TRUE(again.light.flow.empty());
}

// The seed and the polarity of a plan replace those of the setup: one scene, rendered by a changed plan, gives the same
// bits as the scene of a changed setup.
TEST(Render, UsesSeedAndPolarityOfThePlan) {
  auto setup = table1_setup(48);
  setup.medium.field = sinusoid(0.02, 4e-3);
  setup.render.rays_per_dot = 32;
  auto changed = setup;
  changed.render.seed = 99;
  changed.target.polarity = Polarity::dark;
  Device device = cpu();
  for (RenderMethod const method : {RenderMethod::focused_dots, RenderMethod::rays}) {
    setup.render.method = changed.render.method = method;
    Scene const scene = build_scene(setup), other = build_scene(changed);
    RenderPlan plan = plan_rendering(scene);
    Rendering const first = render(scene, plan, device);
    plan.seed = 99;
    plan.polarity = Polarity::dark;
    Rendering const found = render(scene, plan, device), expected = render(other, plan_rendering(other), device);
    EXPECT_EQ(found.truth.displacement_px, expected.truth.displacement_px);
    EXPECT_NE(found.truth.displacement_px, first.truth.displacement_px);
    EXPECT_TRUE(std::equal(found.light.flow.begin(), found.light.flow.end(), expected.light.flow.begin(),
                           expected.light.flow.end()));
  }
}

TEST(Render, RendersTheParticlesOfAPivScene) {
  auto setup = piv_setup(2e-3, 1e-3);
  setup.camera.columns = setup.camera.rows = 64;
  setup.piv->particles.amount = 50;
  Scene const scene = build_scene(setup);
  Device device = cpu();
  Rendering const rendering = render(scene, device);
  EXPECT_EQ(rendering.truth.size(), scene.particles.size());
  EXPECT_GT(*std::max_element(rendering.light.flow.begin(), rendering.light.flow.end()), 0);
}

}  // namespace
}  // namespace gladstone
