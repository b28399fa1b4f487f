#include "render/rays/rays_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "render/base/parallel.h"
#include "render/focused_dots/focused_dots.h"
#include "render/rays/ray_planning.h"
#include "render/rays/ray_theory.h"
#include "render/rays/rays_ladder.h"
#include "render/rays/sample_images.h"
#include "render/rays/source_tracer.h"
#include "render/scene/source_sample.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

Rendering by_rays(PlannedScene scene, RenderImages images = RenderImages::yes,
                  RenderTheory theory = RenderTheory::yes) {
  return RaysRenderer().render(scene, scene.plan, scene.dots, images, theory);
}

double brightest(Image<double> const& image) { return *std::max_element(image.begin(), image.end()); }

/// Returns the rms difference of two images over lit pixels, in grey levels of 12 bits with the brightest pixel at 90 %
/// of full scale.
double levels_between(Image<double> const& a, Image<double> const& b) {
  double const level = brightest(b) / (0.9 * 4095);
  double squares = 0, lit = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (b.data()[i] < level) continue;
    squares += std::pow((a.data()[i] - b.data()[i]) / level, 2);
    ++lit;
  }
  return std::sqrt(squares / lit);
}

/// Table 1 with the late DNS plane: dots of 3 px.
PlannedScene late_scene(std::uint64_t rays) {
  Setup setup = table1_setup(48);
  setup.medium.field = dns_plane("late");
  return scene_with_dots(setup, lattice(48, 2, 17.3), rays);
}

// A scene is rendered by both methods. The truths agree within three times the stated errors of both, plus the
// error of table and rule where their stated errors are far below it. The images agree within half a grey level of 12
// bits, the scatter of these rays; in the measurement image, a third of a level is added, the error of a deflection
// table at any number of rays.
TEST(RaysRenderer, GivesTheTruthAndTheImagesOfFocusedDots) {
  PlannedScene scene = late_scene(65536);
  ASSERT_TRUE(build_focused_dots(scene, scene.plan));
  Rendering const fast = render_all(scene), rays = by_rays(scene);
  for (std::size_t dot = 0; dot < fast.truth.size(); ++dot) {
    Vec2d const off = rays.truth.displacement_px[dot] - fast.truth.displacement_px[dot];
    Vec2d const one = rays.truth.displacement_error_px[dot], other = fast.truth.displacement_error_px[dot];
    EXPECT_LE(std::abs(off.x), 3 * std::hypot(one.x, other.x) + 2e-5) << dot;
    EXPECT_LE(std::abs(off.y), 3 * std::hypot(one.y, other.y) + 2e-5) << dot;
    EXPECT_LT(one.x, 1e-3);
    EXPECT_NEAR(length(rays.truth.reference_px[dot] - fast.truth.reference_px[dot]), 0, 5e-4);
    // both integrate along straight rays, but use different rules for the light cone
    EXPECT_NEAR(length(rays.truth.eq9_px[dot] - fast.truth.eq9_px[dot]), 0, 1e-8);
    EXPECT_NEAR(length(rays.truth.chief_px[dot] - fast.truth.chief_px[dot]), 0, 1e-8);
    EXPECT_NEAR(length(rays.truth.eq9_cone_px[dot] - fast.truth.eq9_cone_px[dot]), 0, 2e-3);
    EXPECT_NEAR(rays.truth.flux[dot].x / fast.truth.flux[dot].x, 1, 1e-4);
  }
  EXPECT_LT(levels_between(rays.light.reference, fast.light.reference), 0.5);
  EXPECT_LT(levels_between(rays.light.flow, fast.light.flow), 0.5 + 1.0 / 3);
}

TEST(RaysRenderer, UndeflectedDotsDoNotMove) {
  auto setup = table1_setup(32);
  setup.medium.field = uniform_gradient(0, 0);
  PlannedScene const scene = scene_with_dots(setup, {{15.3, 16.9}}, 64);
  Rendering const still = by_rays(scene);
  EXPECT_EQ(still.truth.displacement_px[0].x, 0);
  EXPECT_EQ(still.truth.displacement_px[0].y, 0);
  EXPECT_TRUE(std::equal(still.light.reference.begin(), still.light.reference.end(), still.light.flow.begin()));
}

// Eq. 9 exactly, up to small angles: u = -M Z_D K L_z g_x / (n_0 p), v with the opposite sign (F27: 5e-4 off the axis).
TEST(RaysRenderer, ShowsTheDisplacementOfEqNine) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(50, 30);
  PlannedScene const scene = scene_with_dots(setup, {{31.5, 31.5}, {5, 60}}, 512);
  Rendering const rendering = by_rays(scene, RenderImages::no);
  double const per_gradient = 105.0 / 895.0 * 0.25 * setup.medium.gladstone_dale * 0.01 / setup.ambient_index() / 1e-5;
  for (std::size_t dot = 0; dot < 2; ++dot) {
    EXPECT_NEAR(rendering.truth.eq9_px[dot].x, -50 * per_gradient, 1e-7);
    EXPECT_NEAR(rendering.truth.eq9_px[dot].y, 30 * per_gradient, 1e-7);
    EXPECT_NEAR(rendering.truth.displacement_px[dot].x / (-50 * per_gradient), 1, 1e-3);
    EXPECT_NEAR(rendering.truth.displacement_px[dot].y / (30 * per_gradient), 1, 1e-3);
  }
}

TEST(RaysRenderer, GivesTheSameBitsOnAnyNumberOfThreads) {
  PlannedScene const scene = late_scene(256);
  int const threads = thread_count();
  set_thread_count(1);
  Rendering const one = by_rays(scene);
  set_thread_count(3);
  Rendering const three = by_rays(scene);
  set_thread_count(threads);
  EXPECT_TRUE(std::equal(one.light.flow.begin(), one.light.flow.end(), three.light.flow.begin()));
  for (std::size_t dot = 0; dot < one.truth.size(); ++dot) {
    EXPECT_EQ(one.truth.displacement_px[dot], three.truth.displacement_px[dot]);
  }
  EXPECT_EQ(one.statuses, three.statuses);
}

// A source whose rays are deflected by more than its margin is traced again, which takes three times as long. Through a
// sinusoid along x the deflection is in proportion to cos(phase). The light cone is 2.4 mm wide in the medium, so that
// the chief and two of the edge rays are 2.5 rad apart on a wavelength of 3 mm. One of them has at least |cos(pi/2 +
// 2.5)| = 0.6 of the largest deflection, and twice this exceeds it.
TEST(RaysRenderer, MarginOfChiefAndEdgeRaysHoldsAllRaysThroughASmoothField) {
  auto setup = table1_setup(48);
  setup.medium.field = sinusoid(0.2, 3e-3);
  PlannedScene const scene = scene_with_dots(setup, lattice(48, 8, 4.1), 256);  // phases 0.55 rad apart
  RaysLaunch const launch(scene, scene.plan, SpotView{});
  LambertSources<double> const lambert{scene.dots.view(-scene.setup.z_d)};
  double closest = 0;
  std::visit(
      [&](auto const& medium) {
        for (std::size_t dot = 0; dot < scene.dots.centre.size(); ++dot) {
          SourceAim const aim = aim_at_stop(launch, launch.camera.view(), medium, lambert.middle(dot), lambert.reach());
          AimedBundle<double> const bundle = launch.bundle(*aim.disc, aim.shift, aim.margin);
          for (std::uint64_t j = 0; j < launch.rays; ++j) {
            Ray<double> const ray = aim_ray(lambert, bundle, dot, j).ray;
            auto const straight = trace_ray(launch.camera.view(), NoMedium<double>{}, launch.tracing, ray, 1.0);
            auto const bent = trace_ray(launch.camera.view(), medium, launch.tracing, ray, 1.0);
            closest = std::max(closest, length(bent.at_lens - straight.at_lens) / aim.margin);
          }
        }
      },
      scene.medium.view);
  EXPECT_LT(closest, 1);
  EXPECT_GT(closest, 0.45) << "the margin exceeds twice the largest deflection by more than 1 % of the pupil";
}

/// Truth and light of a scene's dots.
struct TracedDots {
  std::vector<DotTruth> truth;
  FramePair<double> light;
  StatusCounts statuses;
};

TracedDots trace_dots(PlannedScene const& scene, RayOrder order) {
  std::optional<AiryTable> airy;
  RaysLaunch const launch(scene, scene.plan, make_spot(scene, airy), StopRim::smooth, order);
  RaysLadder const ladder = RaysLadder::of_points(scene, scene.plan, launch, RenderImages::yes);
  LambertSources<double> const lambert{scene.dots.view(-scene.setup.z_d)};
  int const columns = scene.setup.camera.columns, rows = scene.setup.camera.rows;
  LightImage reference(columns, rows), flow(columns, rows);
  LightImage* const targets[frame_count] = {&reference, &flow};
  TracedDots traced;
  std::visit(
      [&](auto const& medium) {
        SourceTracer tracer(ladder, launch.camera.view(), lambert, medium, true);
        for (std::size_t dot = 0; dot < scene.dots.centre.size(); ++dot) {
          traced.truth.push_back(tracer.trace(dot, targets));
        }
        traced.statuses = tracer.statuses();
      },
      scene.medium.view);
  traced.light = {reference.to_light(), flow.to_light()};
  return traced;
}

// Both orders have the same rays, so that truth and images differ by rounding only: positions of rays, 0.25 m from the
// lens, by 1e-12 px, sums of a source by as much of a pixel's light. The light of 64 rays is added ray by ray, that of
// 1000 by nodes.
TEST(RaysRenderer, OrderOfRaysDoesNotMatter) {
  for (std::uint64_t const rays : {64u, 1000u}) {
    PlannedScene const scene = late_scene(rays);
    TracedDots const one = trace_dots(scene, RayOrder::neighbours), other = trace_dots(scene, RayOrder::sequence);
    EXPECT_EQ(one.statuses, other.statuses);
    for (std::size_t dot = 0; dot < one.truth.size(); ++dot) {
      for (int frame = 0; frame < frame_count; ++frame) {
        CentroidSum<double> const &here = one.truth[dot].hits[frame], &there = other.truth[dot].hits[frame];
        EXPECT_EQ(here.count, there.count);
        EXPECT_NEAR(here.weight / there.weight, 1, 1e-13);
        EXPECT_LT(length(here.mean() - there.mean()), 1e-11);
      }
      EXPECT_LT(length(one.truth[dot].error - other.truth[dot].error), 1e-11);
    }
    // Sums of few rays may be rounded alike in both orders.
    EXPECT_FALSE(rays >= 1000 &&
                 std::equal(one.truth.begin(), one.truth.end(), other.truth.begin(),
                            [](auto const& a, auto const& b) { return a.hits[1].first == b.hits[1].first; }))
        << "the orders are equal";
    for (std::size_t i = 0; i < one.light.flow.size(); ++i) {
      ASSERT_NEAR(one.light.reference.data()[i], other.light.reference.data()[i], 1e-11);
      ASSERT_NEAR(one.light.flow.data()[i], other.light.flow.data()[i], 1e-11);
    }
  }
}

// The truth of a dot depends on its own data only: neither on the number of dots nor on its position in the list.
TEST(RaysRenderer, TruthOfADotIsIndependentOfOthers) {
  PlannedScene all = late_scene(256), turned = all;
  std::reverse(turned.dots.centre.begin(), turned.dots.centre.end());
  GroundTruth const truth = by_rays(all).truth, of_turned = by_rays(turned).truth;
  for (std::size_t dot = 0; dot < truth.size(); ++dot) {
    PlannedScene alone = all;
    alone.dots.centre = {all.dots.centre[dot]};
    EXPECT_EQ(by_rays(alone).truth.displacement_px[0], truth.displacement_px[dot]) << dot;
    EXPECT_EQ(of_turned.displacement_px[truth.size() - 1 - dot], truth.displacement_px[dot]) << dot;
  }
}

// White paper imaged by a thin lens: cos^4 of the angle to the axis.
TEST(RaysRenderer, SeesWhitePaperByTheFourthPowerOfTheCosine) {
  auto const setup = table1_setup(512);
  PlannedScene const scene = scene_with_dots(setup, {{200, 200}}, 64);
  Image<double> const white = render_white_target(scene, scene.plan.seed), expected = render_white_light(scene);
  // 4096 rays and a smoothed edge of the stop; over the light cone at f/11, the mean of cos^4 is 2e-5 less than on the
  // axis
  EXPECT_NEAR(white(0, 0), expected(0, 0), 2e-4);
  EXPECT_NEAR(white(255, 255), 1, 2e-4);
  EXPECT_NEAR(white(400, 100), expected(400, 100), 2e-4);
}

TEST(RaysRenderer, PlansStepAndRaysByTracing) {
  auto setup = table1_setup(64);
  setup.medium.field = sinusoid(0.05, 4e-3);
  setup.camera.bit_depth = 8;
  setup.target.dot_diameter_px = 0;
  PlannedScene scene = scene_with_dots(setup, lattice(64, 3, 15), 64);
  scene.setup.render.rays_per_dot.reset();
  EXPECT_LT(plan_step(scene).change_px, 1e-4);
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  // The goals are reached: half a level in the images, and another seed has the same truth within 1e-3 px.
  EXPECT_LE(measure_image_error(scene, scene.plan, scene.plan.adaptive_criteria.value().level, all_sources(scene)),
            image_tolerance_levels);
  Rendering const one = by_rays(scene, RenderImages::no);
  EXPECT_LE(truth_accuracy(one.truth, truth_tolerance_px).rms_px, truth_tolerance_px);
  scene.plan.seed = 99;
  Rendering const two = by_rays(scene, RenderImages::no);
  for (std::size_t dot = 0; dot < one.truth.size(); ++dot) {
    EXPECT_LT(length(one.truth.displacement_px[dot] - two.truth.displacement_px[dot]), 5 * truth_tolerance_px);
  }
}

}  // namespace
}  // namespace gladstone
