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

/// The plan of "auto", by the fast renderer where the scene is one.
RaysPlan plan_rays(Scene& scene) {
  auto const dots = focused_dots(scene);
  if (!dots) return plan_rays_by_rays(scene);
  RaysPlan const plan = plan_rays(*dots);
  scene.rays_per_dot = plan.rays;
  return plan;
}
RaysPlan plan_rays_anew(Scene& scene) {
  scene.setup.render.rays_per_dot.reset();
  return plan_rays(scene);
}

/// Truth of a scene at another step with the same rays.
GroundTruth truth_at_step(Scene const& scene, double step) {
  Scene other = scene;
  other.step = step;
  return trace_truth(other);
}

// Halving the planned step moves no dot by 1e-4 px: checked with rays of the renderer instead of the plan's five. Point
// dots and a margin of zero gradient at the stop's edge: rays that change sides of the stop are the same in both runs
// to 1e-7.
TEST(PlanStep, HalvingChangesNoDotByATenThousandthOfAPixel) {
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(512);
    setup.target.dot_diameter_px = 0;
    setup.medium.field = dns_plane(instant);
    Scene scene = scene_with_dots(setup, lattice(512, 14, 36), 16);
    StepPlan const plan = plan_step(scene);
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

// A trilinear field's gradient jumps from cell to cell: a quarter of a cell at most. A shock: a quarter of its
// thickness.
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
  StepPlan const plan = plan_step(scene);
  EXPECT_EQ(plan.step_mm, 5.0);
  EXPECT_EQ(scene.step, 5e-3);
  EXPECT_GT(plan.change_px, 0);
  EXPECT_LT(plan.limiting_dot, 100u);
}

TEST(PlanRays, KeepsAGivenNumber) {
  auto setup = table1_setup(64);
  Scene scene = scene_with_dots(setup, {{30, 30}}, 77);
  scene.rays_per_dot = 1;
  RaysPlan const plan = plan_rays(scene);
  EXPECT_EQ(plan.rays, 77u);
  EXPECT_TRUE(std::isnan(plan.truth_error_px)) << "nothing was measured";
  EXPECT_TRUE(std::isnan(plan.image_error_levels));
  EXPECT_TRUE(std::isnan(plan.rays_wanted));
  EXPECT_EQ(plan.excess(), 0);
  EXPECT_EQ(scene.rays_per_dot, 77u);
}

// A chief ray of a point has nothing to average.
TEST(PlanRays, OneChiefRayOfAPointIsEnough) {
  auto setup = table1_setup(64);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.target.dot_diameter_px = 0;
  Scene scene = scene_with_dots(setup, {{30, 30}, {12, 40}}, 1);
  RaysPlan const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.rays, 1u);
  EXPECT_TRUE(plan.converged);
}

// Fronts of a cell's width under a cone of 38 cells: no number of rays mends what table and rules leave of images, by
// which rays of another choice are off. The plan makes both twice as fine, which takes off more than half of it, and
// says what is left.
TEST(PlanRays, MakesTableAndRulesFinerWhereFrontsAskForIt) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 512);
  RaysPlan const usual = measure_table_error(focused_dots(scene).value());
  EXPECT_EQ(usual.fineness, 1);
  RaysPlan const plan = plan_rays_anew(scene);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_LT(plan.rays, usual.rays);
  EXPECT_LT(plan.image_error_levels, usual.image_error_levels / 2) << "of " << usual.image_error_levels;
  EXPECT_FALSE(plan.converged);
  EXPECT_GT(plan.image_error_levels, 0.5);
}

// What is chosen for the table hangs on the view and what lies in it, not on the dots that are there: a dot's truth is
// the same whatever others there are.
TEST(PlanRays, HangsOnNoDots) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene few = scene_with_dots(setup, {{21, 40}}, 1), many = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RaysPlan const one = plan_rays_anew(few), other = plan_rays_anew(many);
  EXPECT_EQ(one.fineness, other.fineness);
  EXPECT_EQ(one.rays, other.rays);
  EXPECT_EQ(one.truth_error_px, other.truth_error_px);
  EXPECT_EQ(one.image_error_levels, other.image_error_levels);
  EXPECT_GT(one.truth_error_px, 0);
}

// Under a cone of 105 cells, at f/4, it says that it cannot reach what is asked.
TEST(PlanRays, AdmitsWhatItCannotReach) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  setup.lens.f_number = 4;
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  RaysPlan const plan = plan_rays_anew(scene);
  EXPECT_FALSE(plan.converged);
  EXPECT_EQ(plan.fineness, 2);
  EXPECT_GT(plan.image_error_levels, 0.5);
  EXPECT_TRUE(std::isnan(plan.rays_wanted)) << "no number would do";
}

// Out of focus every ray's light stays where it lands, and half a grey level under discs twenty deep would take more
// rays than anybody waits for. A dot stops at its budget of processor time, counted and not clocked, and the plan tells
// what was asked, what it got, and what it would have taken. The bounds are on one source, 12 ms, where they were on a
// scene, 60 s: the same for the 5000 dots of 512 x 512 px, and no dot has the fewer rays for the others.
TEST(PlanRays, StaysWithinItsBudget) {
  auto setup = table1_setup(512);
  setup.lens.focus = Focus::medium;
  Scene scene = build_scene(setup);
  plan_step(scene);
  RaysPlan const plan = plan_rays_anew(scene);
  EXPECT_FALSE(plan.converged);
  EXPECT_GT(plan.image_error_levels, image_tolerance_levels);
  double const seconds = ray_seconds(scene) * static_cast<double>(plan.most);
  EXPECT_LE(seconds, source_budget_s);
  EXPECT_GT(2 * seconds, source_budget_s) << "twice as many would not be within it";
  EXPECT_EQ(plan.rays, plan.most);
  EXPECT_GT(plan.rays_wanted, static_cast<double>(plan.rays));
}

// A ray's time is counted in steps and lit pixels; 1024 rays are always taken where they are asked for.
TEST(PlanRays, CountsTheTimeOfARay) {
  auto setup = table1_setup(64);
  setup.medium.field = dns_plane("kepeak");
  Scene scene = scene_with_dots(setup, lattice(64, 4, 14), 1);
  double const coarse = rays_seconds(scene), steps = scene.steps_across();
  scene.step /= 10;
  EXPECT_NEAR(rays_seconds(scene) - coarse, 16 * 9 * steps * 0.12e-6, 1e-12);
  scene.step /= 1e5;  // a tenth of a second for every ray of a dot: none would be within the budget
  EXPECT_GT(ray_seconds(scene), source_budget_s);
  EXPECT_EQ(most_rays_of_source(scene), 1024u);
}

// The promise: truth to 1e-3 px rms and the flow picture to half a grey level of 12 bits rms over lit pixels, against
// 65,536 rays by themselves, which scatter by some 4e-4 px and a third of a level.
TEST(PlanRays, KeepsItsPromiseAgainstManyRaysByThemselves) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.015, 5e-3);
  Scene scene = scene_with_dots(setup, lattice(64, 3, 18), 1);
  RaysPlan const plan = plan_rays_anew(scene);
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

/// rms over lit pixels of the scatter of one picture, from two of other seeds, in grey levels of 12 bits when the
/// brightest pixel of both frames is at 90 % of full scale; the worse frame's.
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

// What is said of pictures from single dots holds for the pictures of all of them, out of focus too, where discs of 39
// px lie over each other twenty deep and every ray's light stays where it lands. The scatter itself is found to a few
// percent; the brightest pixel, of which it is a share, is estimated as three standard deviations above the mean where
// dots overlap: 25 %.
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
    double const estimated = measure_rays_by_rays(scene).image_error_levels, found = scatter_of_pictures(scene);
    EXPECT_NEAR(estimated / found, 1, 0.25) << estimated << " levels for " << found;
  }
}

/// What a scene's fast picture of the flow is off by beside 65,536 rays alone, which scatter by a third of a level.
double table_is_off(Scene const& scene) {
  Scene fast = scene, many = scene;
  many.rays_per_dot = 65536;
  Rendering const exact = RaysRenderer().render(many, many.dots, RenderImages::yes, RenderTheory::no);
  Rendering const found = FocusedDotsRenderer().render(fast, fast.dots, RenderImages::yes, RenderTheory::no);
  EXPECT_TRUE(found.left.empty());
  return picture_error(found.light.flow, exact.light.flow).rms_levels;
}

// Where fronts spread a dot's rays over pixels a table is off by levels, and says by how many: nine dots by the scene's
// own light, each by its own, a factor of two allowed for the fronts that they see.
TEST(MeasureTableError, TellsHowFarImagesAreOff) {
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(64);
    setup.medium.field = dns_plane(instant);
    Scene const scene = scene_with_dots(setup, lattice(64, 3, 20), 128);
    RaysPlan const told = measure_table_error(focused_dots(scene).value());
    double const found = table_is_off(scene);
    EXPECT_LT(told.image_error_levels, 2 * found) << instant << " found " << found;
    EXPECT_GT(std::hypot(told.image_error_levels, 0.4), found / 2) << instant << " found " << found;
  }
}

// A uniform gradient bends all rays of a dot alike but for second order: what the table is off by is below what the
// rays of the measurement scatter by, and is not told from nothing.
TEST(MeasureTableError, TellsWhatItCanResolve) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(20, 10);
  Scene const scene = scene_with_dots(setup, lattice(64, 3, 20), 32);
  RaysPlan const told = measure_table_error(focused_dots(scene).value());
  EXPECT_GT(told.truth_resolution_px, 0);
  EXPECT_LT(told.truth_resolution_px, 1e-4);
  EXPECT_GT(told.image_resolution_levels, 0);
  EXPECT_LT(told.truth_error_px, 2 * told.truth_resolution_px);
}

// A uniform gradient moves all dots alike, by 2.6 px or by 60: what is told of their images is the same to what rays of
// another choice scatter by.
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

// A dot that no scrambling shows tells nothing; one that some of them show moves from there to nowhere, which scatters.
TEST(RayScatter, ADotThatIsNotSeenTellsNothing) {
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
