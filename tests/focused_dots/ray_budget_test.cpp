#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/base/random.h"
#include "render/focused_dots/table_error.h"
#include "render/scene/ray_scatter.h"
#include "tests/focused_dots/picture_error.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Returns the automatic plan, by the fast renderer if it supports the scene.
RayBudget determine_ray_budget(Scene& scene) {
  auto const dots = focused_dots(scene);
  if (dots) {
    RayBudget const plan = determine_ray_budget(*dots);
    scene.rays_per_dot = plan.rays;
    return plan;
  }
  RayBudget const plan = determine_ray_budget_by_tracing(scene);
  scene = with_rays(std::move(scene), plan);
  return plan;
}
RayBudget plan_rays_anew(Scene& scene) {
  scene.setup.render.rays_per_dot.reset();
  return determine_ray_budget(scene);
}

/// Returns the truth of a scene with another step and the same rays.
GroundTruth truth_at_step(Scene const& scene, double step) {
  Scene other = scene;
  other.step = step;
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
    Scene scene = scene_with_dots(setup, lattice(512, 14, 36), 16);
    IntegrationStep const plan = plan_step(scene);
    EXPECT_LT(plan.change_px, 1e-4);
    EXPECT_EQ(scene.step, plan.step_mm * 1e-3);
    EXPECT_LE(scene.step, scene.medium.coarsest_step);
    EXPECT_GE(scene.pupil_margin, plan.largest_shift);
    GroundTruth const coarse = truth_at_step(scene, scene.step), fine = truth_at_step(scene, scene.step / 2);
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
  Scene trilinear = scene_with_dots(setup, {{20, 20}, {40, 45}}, 1);
  EXPECT_LE(trilinear.step, 0.0625e-3 / 4);

  setup = table1_setup(64);
  setup.medium.field = NormalShock<double>::front(1.5, 0.3, 0.4e-3, 0.3);
  Scene shock = scene_with_dots(setup, {{20, 20}, {40, 45}}, 1);
  EXPECT_LE(shock.step, 0.4e-3 / 4);
}

TEST(PlanStep, KeepsAGivenStepAndMeasuresIt) {
  auto setup = table1_setup(512);
  setup.medium.field = dns_plane("kepeak");
  setup.medium.step_mm = 5.0;
  Scene scene = scene_with_dots(setup, lattice(512, 10, 50), 1);
  IntegrationStep const plan = plan_step(scene);
  EXPECT_EQ(plan.step_mm, 5.0);
  EXPECT_EQ(scene.step, 5e-3);
  EXPECT_GT(plan.change_px, 0);
  EXPECT_LT(plan.limiting_dot, 100u);
}

TEST(PlanRays, KeepsAGivenNumber) {
  auto setup = table1_setup(64);
  Scene scene = scene_with_dots(setup, {{30, 30}}, 77);
  scene.rays_per_dot = 1;
  RayBudget const plan = determine_ray_budget(scene);
  EXPECT_EQ(plan.rays, 77u);
  EXPECT_TRUE(std::isnan(plan.truth_error_px)) << "nothing was measured";
  EXPECT_TRUE(std::isnan(plan.image_error_levels));
  EXPECT_TRUE(std::isnan(plan.rays_wanted));
  EXPECT_EQ(plan.excess(), 0);
  EXPECT_EQ(scene.rays_per_dot, 77u);
}

// The chief ray of a point needs no average.
TEST(PlanRays, OneChiefRayOfAPointIsEnough) {
  auto setup = table1_setup(64);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.target.dot_diameter_px = 0;
  Scene scene = scene_with_dots(setup, {{30, 30}, {12, 40}}, 1);
  RayBudget const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.rays, 1u);
  EXPECT_TRUE(plan.converged);
}

// Fronts as narrow as a cell, with a light cone of 38 cells: the error of table and rules in images does not decrease
// with the number of rays. The plan refines both by a factor of two, which reduces the error by more than half, and
// reports the remaining error.
TEST(PlanRays, MakesTableAndRulesFinerWhereFrontsAskForIt) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 512);
  RayBudget const usual = measure_table_error(focused_dots(scene).value());
  EXPECT_EQ(usual.fineness, 1);
  RayBudget const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_LT(plan.rays, usual.rays);
  EXPECT_LT(plan.image_error_levels, usual.image_error_levels / 2) << "of " << usual.image_error_levels;
  EXPECT_FALSE(plan.converged);
  EXPECT_GT(plan.image_error_levels, 0.5);
}

// The plan of the table depends on the view and the field, not on the dots of the scene: the truth of a dot is
// independent of the others.
TEST(PlanRays, IsIndependentOfDots) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene few = scene_with_dots(setup, {{21, 40}}, 1), many = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RayBudget const one = plan_rays_anew(few), other = plan_rays_anew(many);
  EXPECT_EQ(one.fineness, other.fineness);
  EXPECT_EQ(one.rays, other.rays);
  EXPECT_EQ(one.truth_error_px, other.truth_error_px);
  EXPECT_EQ(one.image_error_levels, other.image_error_levels);
  EXPECT_GT(one.truth_error_px, 0);
}

// With a light cone of 105 cells, at f/4, the plan reports that the required accuracy cannot be reached.
TEST(PlanRays, ReportsUnreachableTolerance) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  setup.lens.f_number = 4;
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RayBudget const plan = plan_rays_anew(scene);
  EXPECT_FALSE(plan.converged);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_GT(plan.image_error_levels, 0.5);
  EXPECT_TRUE(std::isnan(plan.rays_wanted)) << "no number of rays is sufficient";
}

// Out of focus, the light of every ray stays where it lands, and half a grey level with twenty overlapping discs would
// need too many rays. The number is limited by a budget of processor time per dot, which is estimated, not measured.
// The plan reports the requirement, the achieved accuracy, and the number of rays that would be needed. The budget
// applies per source, 12 ms, so that the number of rays of a dot does not depend on the others: 60 s for the 5000 dots
// of 512 x 512 px.
TEST(PlanRays, StaysWithinItsBudget) {
  auto setup = table1_setup(512);
  setup.lens.focus = Focus::medium;
  Scene scene = build_scene(setup);
  plan_step(scene);
  RayBudget const plan = plan_rays_anew(scene);
  EXPECT_FALSE(plan.converged);
  EXPECT_GT(plan.image_error_levels, image_tolerance_levels);
  double const seconds = ray_seconds(scene) * static_cast<double>(plan.most);
  EXPECT_LE(seconds, source_budget_s);
  EXPECT_GT(2 * seconds, source_budget_s) << "twice as many would exceed the budget";
  EXPECT_EQ(plan.rays, plan.most);
  EXPECT_GT(plan.rays_wanted, static_cast<double>(plan.rays));
}

// The time of a ray is estimated from the numbers of steps and lit pixels; up to 1024 rays are always allowed.
TEST(PlanRays, CountsTheTimeOfARay) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  double const coarse = rays_seconds(scene), steps = scene.steps_across();
  scene.step /= 10;
  EXPECT_NEAR(rays_seconds(scene) - coarse, 16 * 9 * steps * 0.12e-6, 1e-12);
  scene.step /= 1e5;  // a tenth of a second for every ray of a dot: none would be within the budget
  EXPECT_GT(ray_seconds(scene), source_budget_s);
  EXPECT_EQ(max_rays_per_source(scene), 1024u);
}

// The stated accuracy is reached: truth to 1e-3 px rms, and the measurement image to half a grey level of 12 bits, rms
// over lit pixels, compared with 65,536 rays alone, whose scatter is about 4e-4 px and a third of a level.
TEST(PlanRays, EstimatedErrorMatchesReferenceWithManyRays) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.015, 5e-3);
  Scene scene = scene_with_dots(setup, lattice(64, 3, 18), 1);
  RayBudget const plan = plan_rays_anew(scene);
  ASSERT_TRUE(plan.converged) << plan.rays << " rays, " << plan.truth_error_px << " px, " << plan.image_error_levels
                              << " levels";
  EXPECT_EQ(plan.bits, 12);
  EXPECT_LE(plan.truth_error_px, 1e-3);
  EXPECT_LE(plan.image_error_levels, 0.5);
  Rendering const chosen = render_all(scene);
  Scene many = scene;
  many.rays_per_dot = 65536;
  Rendering const reference = RaysRenderer().render(many, many.dots, RenderImages::yes, RenderTheory::no);
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

/// Returns the scatter of an image in the worse frame, from two images with different seeds: rms over lit pixels, in
/// grey levels of 12 bits with the brightest pixel of both frames at 90 % of full scale.
double scatter_of_pictures(Scene scene) {
  LightPair const one = RaysRenderer().render(scene, scene.dots, RenderImages::yes, RenderTheory::no).light;
  scene.setup.render.seed = repeat_seed(scene.setup.render.seed, 5);
  LightPair const other = RaysRenderer().render(scene, scene.dots, RenderImages::yes, RenderTheory::no).light;
  double const level = std::max(*std::max_element(one.reference.begin(), one.reference.end()),
                                *std::max_element(one.flow.begin(), one.flow.end())) /
                       (0.9 * 4095);
  double worse = 0;
  for (auto frame : {&LightPair::reference, &LightPair::flow}) {
    double square = 0;
    int lit = 0;
    for (std::size_t i = 0; i < (one.*frame).size(); ++i) {
      double const a = (one.*frame).data()[i], b = (other.*frame).data()[i];
      if (a + b < 2 * level) continue;
      square += (a - b) * (a - b) / (2 * level * level);
      ++lit;
    }
    worse = std::max(worse, std::sqrt(square / std::max(lit, 1)));
  }
  return worse;
}

// The image error estimated from single dots applies to images of all dots, also out of focus, where discs of 39 px
// overlap twenty-fold and every ray's light stays where it lands. The estimate of the scatter itself is accurate to a
// few per cent; that of the brightest pixel, to which it refers, is three standard deviations above the mean where dots
// overlap: 25 %.
TEST(MeasureRays, FindsTheScatterOfWholePictures) {
  for (Focus const focus : {Focus::target, Focus::medium}) {
    auto setup = table1_setup(64);
    setup.lens.focus = focus;
    setup.medium.field = sinusoid(0.1, 5e-3);
    setup.view_margin_px = 32;
    setup.render.method = RenderMethod::rays;
    Scene scene = build_scene(setup);
    plan_step(scene);
    scene.rays_per_dot = focus == Focus::target ? 256 : 2048;
    double const estimated = measure_errors_by_tracing(scene).image_error_levels, found = scatter_of_pictures(scene);
    EXPECT_NEAR(estimated / found, 1, 0.25) << estimated << " levels for " << found;
  }
}

/// Returns the error of the measurement image by the fast renderer, compared with 65,536 rays alone, whose scatter is a
/// third of a level.
double table_is_off(Scene const& scene) {
  Scene fast = scene, many = scene;
  many.rays_per_dot = 65536;
  Rendering const exact = RaysRenderer().render(many, many.dots, RenderImages::yes, RenderTheory::no);
  Rendering const found = FocusedDotsRenderer().render(fast, fast.dots, RenderImages::yes, RenderTheory::no);
  EXPECT_TRUE(found.left.empty());
  return picture_error(found.light.flow, exact.light.flow).rms_levels;
}

// If fronts spread a dot's rays over pixels, the error of a table is several grey levels, and it is reported: nine dots
// are compared, each with the measured error of images; a factor of two is allowed for the fronts that they see.
TEST(MeasureTableError, TellsHowFarImagesAreOff) {
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(64);
    setup.medium.field = dns_plane(instant);
    Scene const scene = scene_with_dots(setup, lattice(64, 3, 20), 128);
    RayBudget const told = measure_table_error(focused_dots(scene).value());
    double const found = table_is_off(scene);
    EXPECT_LT(told.image_error_levels, 2 * found) << instant << " found " << found;
    EXPECT_GT(std::hypot(told.image_error_levels, 0.4), found / 2) << instant << " found " << found;
  }
}

// A uniform gradient deflects all rays of a dot equally up to second order: the error of the table is below the scatter
// of the rays by which it is measured, and cannot be distinguished from zero.
TEST(MeasureTableError, TellsWhatItCanResolve) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(20, 10);
  Scene const scene = scene_with_dots(setup, lattice(64, 3, 20), 32);
  RayBudget const told = measure_table_error(focused_dots(scene).value());
  EXPECT_GT(told.truth_resolution_px, 0);
  EXPECT_LT(told.truth_resolution_px, 1e-4);
  EXPECT_GT(told.image_resolution_levels, 0);
  EXPECT_LT(told.truth_error_px, 2 * told.truth_resolution_px);
}

// A uniform gradient displaces all dots equally, by 2.6 px or by 60 px: the detection limit of the image error is about
// the same for both.
TEST(MeasureTableError, FollowsDotsThatMoveFar) {
  double told[2] = {};
  for (double const gradient : {400.0, 9000.0}) {
    auto setup = table1_setup(64);
    setup.medium.field = uniform_gradient(gradient, 10);
    Scene const scene = scene_with_dots(setup, lattice(64, 3, 20), 32);
    told[gradient > 400 ? 1 : 0] = measure_table_error(focused_dots(scene).value()).image_resolution_levels;
  }
  EXPECT_GT(told[0], 0);
  EXPECT_GT(told[1], told[0] / 2);
}

// A dot that is invisible in all scramblings is ignored; one that is visible in some of them counts as displaced from
// its position to zero, which increases the scatter.
TEST(RayScatter, InvisibleDotsDoNotCount) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  MeanDisplacement const unseen = MeanDisplacement::of({{nan, nan}, {nan, nan}, {nan, nan}, {nan, nan}});
  MeanDisplacement const twice = MeanDisplacement::of({{1, 0}, {nan, nan}, {1, 0}, {nan, nan}});
  MeanDisplacement const still = MeanDisplacement::of({{1, 0}, {1, 0}, {1, 0}, {1, 0}});
  EXPECT_TRUE(std::isnan(unseen.variance));
  EXPECT_DOUBLE_EQ(twice.variance, 1.0 / 6);  // (4 x 0.25)/3 along x, 0 along y
  EXPECT_EQ(still.variance, 0);
  EXPECT_DOUBLE_EQ(mean_variance({unseen, twice, still}), 1.0 / 12);
  EXPECT_TRUE(std::isnan(mean_variance({unseen})));
}

}  // namespace
}  // namespace gladstone
