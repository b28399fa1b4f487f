#include <gtest/gtest.h>

#include <cmath>

#include "render/focused_dots/table_error.h"
#include "render/rays/sample_images.h"
#include "render/scene/source_sample.h"
#include "tests/focused_dots/picture_error.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Plans the rays of a scene with rays_per_dot = "auto", by the fast renderer if it supports the scene.
RenderPlan plan_rays_anew(PlannedScene& scene) {
  scene.plan.given_rays.reset();
  auto const dots = build_focused_dots(scene, scene.plan);
  return scene.plan = dots ? plan_rays_by_table(*dots) : plan_rays_by_tracing(scene, scene.plan);
}

/// Returns the truth of a scene with another step and the same rays.
GroundTruth truth_at_step(PlannedScene const& scene, double step) {
  PlannedScene other = scene;
  other.plan.step = step;
  return trace_truth(other);
}

// Halving the planned step changes no displacement by 1e-4 px, checked with rays of the renderer instead of the five
// rays of the plan. Dots are points, and the stop's edge has a margin of zero gradient: rays that change sides of the
// edge are the same in both runs to 1e-7.
TEST(PlanStep, HalvingChangesNoDotByATenThousandthOfAPixel) {
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(512);
    setup.target.dot_diameter_px = 0;
    setup.medium.field = dns_plane(instant);
    PlannedScene scene = scene_with_dots(setup, lattice(512, 14, 36), 16);
    IntegrationStep const plan = plan_step(scene);
    EXPECT_LT(plan.change_px, 1e-4);
    EXPECT_EQ(scene.plan.step, plan.step_mm * 1e-3);
    EXPECT_LE(scene.plan.step, scene.medium.coarsest_step);  // beyond it, a step may miss structures of the field
    EXPECT_GE(scene.plan.pupil_margin, plan.largest_shift);
    GroundTruth const coarse = truth_at_step(scene, scene.plan.step), fine = truth_at_step(scene, scene.plan.step / 2);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      if (coarse.rays[i] != fine.rays[i]) continue;
      moved += length(coarse.displacement_px[i] - fine.displacement_px[i]) > 1e-4;
    }
    EXPECT_EQ(moved, 0u) << instant;
  }
}

// The gradient of a trilinear field is discontinuous between cells: the step is at most a quarter of a cell. For a
// shock, it is at most a quarter of its thickness.
TEST(PlanStep, ResolvesCellsAndShocks) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("late");
  setup.medium.interpolation = FieldInterpolation::trilinear;
  PlannedScene trilinear = scene_with_dots(setup, {{20, 20}, {40, 45}}, 1);
  EXPECT_LE(trilinear.plan.step, 0.0625e-3 / 4);

  setup = table1_setup(64);
  setup.medium.field = NormalShock<double>::front(1.5, 0.3, 0.4e-3, 0.3);
  PlannedScene shock = scene_with_dots(setup, {{20, 20}, {40, 45}}, 1);
  EXPECT_LE(shock.plan.step, 0.4e-3 / 4);
}

TEST(PlanStep, KeepsAGivenStepAndMeasuresIt) {
  auto setup = table1_setup(512);
  setup.medium.field = dns_plane("kepeak");
  setup.medium.step_mm = 5.0;
  PlannedScene scene = scene_with_dots(setup, lattice(512, 10, 50), 1);
  IntegrationStep const plan = plan_step(scene);
  EXPECT_EQ(plan.step_mm, 5.0);
  EXPECT_EQ(scene.plan.step, 5e-3);
  EXPECT_GT(plan.change_px, 0);
  EXPECT_LT(plan.limiting_dot, 100u);
}

TEST(PlanRays, KeepsAGivenNumber) {
  auto setup = table1_setup(64);
  PlannedScene const scene = scene_with_dots(setup, {{30, 30}}, 77);
  for (RenderPlan const& plan :
       {plan_rays_by_table(build_focused_dots(scene, scene.plan).value()), plan_rays_by_tracing(scene, scene.plan)}) {
    EXPECT_EQ(plan.rays, 77u);
    EXPECT_FALSE(plan.adaptive_criteria);
    EXPECT_FALSE(plan.table_error) << "nothing was measured";
  }
}

// The chief ray of a point needs no average.
TEST(PlanRays, OneChiefRayOfAPointIsEnough) {
  auto setup = table1_setup(64);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.target.dot_diameter_px = 0;
  PlannedScene scene = scene_with_dots(setup, {{30, 30}, {12, 40}}, 1);
  RenderPlan const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.rays, 1u);
}

// Fronts as narrow as a cell, with a light cone of 38 cells: the error of table and rules in images does not decrease
// with the number of rays. The plan refines both by a factor of two, which reduces the error by more than half, and
// reports that the goal is not reached.
TEST(PlanRays, MakesTableAndRulesFinerWhereFrontsAskForIt) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  PlannedScene scene = scene_with_dots(setup, lattice(64, 4, 14), refined_table_rays);
  TableError const usual = measure_table_error(build_focused_dots(scene, scene.plan).value());
  EXPECT_EQ(usual.fineness, 1);
  RenderPlan const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_EQ(plan.rays, refined_table_rays);  // as in the scene above, whose table is not finer
  TableError const error = plan.table_error.value();
  EXPECT_LT(error.image_levels, usual.image_levels / 2) << "of " << usual.image_levels;
  EXPECT_GT(error.image_levels, 0.5);  // half a level is the goal
  EXPECT_GT(error.excess(), 1);
}

// With a light cone of 105 cells, at f/4, the plan reports that the required accuracy, half a level, is not reached.
TEST(PlanRays, ReportsUnreachableTolerance) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  setup.lens.f_number = 4;
  PlannedScene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RenderPlan const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_GT(plan.table_error.value().image_levels, 0.5);
  EXPECT_GT(plan.table_error->excess(), 1);
}

// The plan of the table depends on the view and the field, not on the dots of the scene: the truth of a dot is
// independent of the others.
TEST(PlanRays, IsIndependentOfDots) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.015, 5e-3);
  PlannedScene few = scene_with_dots(setup, {{21, 40}}, 1), many = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RenderPlan const one = plan_rays_anew(few), other = plan_rays_anew(many);
  EXPECT_EQ(one.fineness, other.fineness);
  EXPECT_EQ(one.rays, other.rays);
  TableError const &a = one.table_error.value(), &b = other.table_error.value();
  EXPECT_EQ(a.truth_px, b.truth_px);
  EXPECT_EQ(a.image_levels, b.image_levels);
  EXPECT_EQ(a.truth_resolution_px, b.truth_resolution_px);
  EXPECT_EQ(a.image_resolution_levels, b.image_resolution_levels);
  EXPECT_GT(a.image_resolution_levels, 0);  // truth_px may be 0: in this smooth field it is below its resolution
}

// The number of rays of a source is limited by a budget of processor time, which is estimated, not measured. The budget
// applies per source, 12 ms, so that the number of rays of a dot does not depend on the others: 60 s for the 5000 dots
// of 512 x 512 px. Out of focus, half a grey level with twenty overlapping discs would need more.
TEST(PlanRays, StaysWithinItsBudget) {
  auto setup = table1_setup(512);
  setup.lens.focus = Focus::medium;
  PlannedScene scene(build_scene(setup));
  plan_step(scene);
  RenderPlan const plan = plan_rays_anew(scene);
  double const seconds = ray_seconds(scene, scene.plan) * static_cast<double>(plan.rays);
  EXPECT_LE(seconds, source_budget_s);
  EXPECT_GT(2 * seconds, source_budget_s) << "twice as many would exceed the budget";
  EXPECT_GT(measure_image_error(scene, scene.plan, scene.plan.adaptive_criteria.value().level, all_sources(scene)),
            image_tolerance_levels);
  scene.dots = select_dots(scene.dots, {0, 100, 200});
  for (std::int64_t const rays : render_all(scene).truth.rays_planned) {
    EXPECT_EQ(rays, static_cast<std::int64_t>(plan.rays));
  }
}

// The time of a ray is estimated from the numbers of steps and lit pixels; up to 1024 rays are always allowed.
TEST(PlanRays, CountsTheTimeOfARay) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  PlannedScene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  double const coarse = rays_seconds(scene, scene.plan), steps = scene.steps_across(scene.plan.step);
  scene.plan.step /= 10;
  EXPECT_NEAR(rays_seconds(scene, scene.plan) - coarse, 16 * 9 * steps * 0.12e-6, 1e-12);
  scene.plan.step /= 1e5;  // a tenth of a second for every ray of a dot: none would be within the budget
  EXPECT_GT(ray_seconds(scene, scene.plan), source_budget_s);
  EXPECT_EQ(max_rays_per_source(scene, scene.plan), 1024u);
}

// The stated accuracy is reached: truth to 1e-3 px rms, and the measurement image to half a grey level of 12 bits, rms
// over lit pixels, compared with 65,536 rays alone, whose scatter is about 4e-4 px and a third of a level.
TEST(PlanRays, EstimatedErrorMatchesReferenceWithManyRays) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.015, 5e-3);
  PlannedScene scene = scene_with_dots(setup, lattice(64, 3, 18), 1);
  RenderPlan const plan = plan_rays_anew(scene);
  TableError const stated = plan.table_error.value();
  // An excess of 1 is the goal: 1e-3 px of the truth, or half a level of images.
  ASSERT_LE(stated.excess(), 1) << plan.rays << " rays, " << stated.truth_px << " px, " << stated.image_levels
                                << " levels";
  EXPECT_EQ(stated.bits, 12);
  Rendering const chosen = render_all(scene);
  PlannedScene many = scene;
  many.plan.rays = 65536;
  Rendering const reference = RaysRenderer().render(many, many.plan, many.dots, RenderImages::yes, RenderTheory::no);
  double square = 0;
  for (std::size_t i = 0; i < chosen.truth.size(); ++i) {
    Vec2d const error = chosen.truth.displacement_px[i] - reference.truth.displacement_px[i];
    square += dot(error, error) / (2.0 * static_cast<double>(chosen.truth.size()));
  }
  EXPECT_LT(std::sqrt(square), 1e-3);
  PictureError const error = picture_error(chosen.light.flow, reference.light.flow);
  ASSERT_GT(error.lit, 100);
  EXPECT_LT(error.rms_levels, std::hypot(0.5, 0.4));
}

/// Returns the error of the measurement image by the fast renderer, compared with 65,536 rays alone, whose scatter is a
/// third of a level.
double table_is_off(PlannedScene const& scene) {
  PlannedScene fast = scene, many = scene;
  many.plan.rays = 65536;
  Rendering const exact = RaysRenderer().render(many, many.plan, many.dots, RenderImages::yes, RenderTheory::no);
  Rendering const found = FocusedDotsRenderer().render(fast, fast.plan, fast.dots, RenderImages::yes, RenderTheory::no);
  EXPECT_TRUE(found.left.empty());
  return picture_error(found.light.flow, exact.light.flow).rms_levels;
}

// If fronts spread a dot's rays over pixels, the error of a table is several grey levels, and it is reported: nine dots
// are compared, each with the measured error of images; a factor of two is allowed for the fronts that they see.
TEST(MeasureTableError, TellsHowFarImagesAreOff) {
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(64);
    setup.medium.field = dns_plane(instant);
    PlannedScene const scene = scene_with_dots(setup, lattice(64, 3, 20), 128);
    TableError const told = measure_table_error(build_focused_dots(scene, scene.plan).value());
    double const found = table_is_off(scene);
    EXPECT_LT(told.image_levels, 2 * found) << instant << " found " << found;
    EXPECT_GT(std::hypot(told.image_levels, 0.4), found / 2) << instant << " found " << found;
  }
}

// A uniform gradient deflects all rays of a dot equally up to second order: the error of the table is below the scatter
// of the rays by which it is measured, and cannot be distinguished from zero.
TEST(MeasureTableError, TellsWhatItCanResolve) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(20, 10);
  PlannedScene const scene = scene_with_dots(setup, lattice(64, 3, 20), 32);
  TableError const told = measure_table_error(build_focused_dots(scene, scene.plan).value());
  EXPECT_GT(told.truth_resolution_px, 0);
  EXPECT_LT(told.truth_resolution_px, 1e-4);
  EXPECT_GT(told.image_resolution_levels, 0);
  EXPECT_LT(told.truth_px, 2 * told.truth_resolution_px);
}

// A uniform gradient displaces all dots equally, by 2.6 px or by 60 px: the detection limit of the image error is about
// the same for both.
TEST(MeasureTableError, FollowsDotsThatMoveFar) {
  double told[2] = {};
  for (double const gradient : {400.0, 9000.0}) {
    auto setup = table1_setup(64);
    setup.medium.field = uniform_gradient(gradient, 10);
    PlannedScene const scene = scene_with_dots(setup, lattice(64, 3, 20), 32);
    told[gradient > 400 ? 1 : 0] =
        measure_table_error(build_focused_dots(scene, scene.plan).value()).image_resolution_levels;
  }
  EXPECT_GT(told[0], 0);
  EXPECT_GT(told[1], told[0] / 2);
}

}  // namespace
}  // namespace gladstone
