#include "render/rays/sample_images.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/base/random.h"
#include "render/scene/source_sample.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Returns the set-up of Table 1 with a sinusoidal density; its dots extend 32 px beyond the view.
PlannedScene wave_scene(Focus focus) {
  auto setup = table1_setup(64);
  setup.lens.focus = focus;
  setup.medium.field = sinusoid(0.1, 5e-3);
  setup.view_margin_px = 32;
  setup.render.method = RenderMethod::rays;
  PlannedScene scene(build_scene(setup));
  plan_step(scene);
  return scene;
}

/// Returns the light of a grey level of 12 bits with the brightest pixel of both frames at 90 % of full scale.
double level_of(FramePair<double> const& light) {
  return std::max(*std::max_element(light.reference.begin(), light.reference.end()),
                  *std::max_element(light.flow.begin(), light.flow.end())) /
         (0.9 * 4095);
}

FramePair<double> render_light(PlannedScene const& scene) {
  return RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no).light;
}

/// Returns the scatter of an image in the worse frame, from this and another one with another seed: rms over lit pixels
/// [levels].
double scatter_of_images(PlannedScene scene, FramePair<double> const& one, double level) {
  scene.plan.seed = repeat_seed(scene.plan.seed, 5);
  FramePair<double> const other = render_light(scene);
  double worse = 0;
  for (auto frame : {&FramePair<double>::reference, &FramePair<double>::flow}) {
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

// The standard error measured on a sample applies to images of all dots, also out of focus, where discs of 39 px
// overlap twenty-fold and every ray's light stays where it lands. In focus about a thousand lit pixels of 96 dots
// determine it to 3 %, and the number of lit pixels of all dots is known to 10 % where regular dots are taken for
// random ones; out of focus the 12 discs that are as large as the view give 15 %.
TEST(ImageError, IsTheScatterOfImagesOfAllDots) {
  for (Focus const focus : {Focus::target, Focus::medium}) {
    PlannedScene scene = wave_scene(focus);
    scene.plan.rays = focus == Focus::target ? 256 : 2048;
    FramePair<double> const light = render_light(scene);
    double const level = level_of(light), found = scatter_of_images(scene, light, level);
    double const stated = measure_image_error(scene, scene.plan, level, all_sources(scene));
    EXPECT_GT(found, 0.1);
    EXPECT_NEAR(stated / found, 1, 0.25) << stated << " levels for " << found;
  }
}

// With adaptive numbers of rays, the stated standard error is the scatter, too.
TEST(ImageError, IsTheScatterOfAdaptiveRays) {
  PlannedScene scene = wave_scene(Focus::target);
  scene.setup.camera.bit_depth = 8;
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  FramePair<double> const light = render_light(scene);
  double const level = level_of(light) * 4095 / 255;
  double const stated = measure_image_error(scene, scene.plan, level, all_sources(scene)),
               found = scatter_of_images(scene, light, level);
  EXPECT_NEAR(stated / found, 1, 0.25) << stated << " levels for " << found;
}

// The sample of 96 dots determines the exposure of the image of all dots. Its estimate, three standard deviations above
// the mean where dots overlap, is that of the brightest of some thousand pixels to 25 %.
TEST(BrightestPixel, IsThatOfTheImageOfAllDots) {
  for (Focus const focus : {Focus::target, Focus::medium}) {
    PlannedScene scene = wave_scene(focus);
    scene.plan.rays = 256;
    double const found = level_of(render_light(scene)) * 0.9 * 4095;
    EXPECT_NEAR(brightest_pixel(render_sample(scene, scene.plan, all_sources(scene))) / found, 1, 0.25);
  }
}

}  // namespace
}  // namespace gladstone
