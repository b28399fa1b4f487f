#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "render/rays/ray_planning.h"
#include "render/rays/rays_renderer.h"
#include "tests/scene/read_setup_text.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

Rendering rendered_with_images(PlannedScene& scene) {
  return RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
}

double all_light(Image<double> const& image) { return std::accumulate(image.begin(), image.end(), 0.0); }

// An object-space telecentric lens, positioned by its first vertex, in front of a uniform gradient: light is deflected
// by eps = K L g / n0, and dots are displaced by M Z_D eps / p, with M of the lens at their distance, whatever is
// between.
TEST(TelecentricRendering, DisplacesDotsByTheLensMagnification) {
  gladstone::Setup setup =
      read_setup_text("[camera]\npixels = [128, 128]\n[lens]\nmodel = \"prescription\"\nfile = \"" +
                      std::string(GLADSTONE_DATA_DIR) +
                      "/lenses/telecentric.toml\"\nf_number = 11.0\n[geometry]\nz_front_mm = 960.0\nz_d_mm = 200.0\n"
                      "[medium.field]\nkind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]\n")
          .setup;
  PlannedScene scene(build_scene(setup));
  plan_step(scene);
  scene.plan.rays = 256;
  Rendering const result = rendered_with_images(scene);
  double const M = scene.imaging.magnification;
  EXPECT_NEAR(M, 0.2, 0.004);
  double const K = setup.medium.gladstone_dale, n0 = setup.ambient_index();
  double const scale = M * 0.2 * K * 0.01 / n0 / 10e-6;
  std::size_t seen = 0;
  double squares = 0, errors = 0;
  for (std::size_t dot = 0; dot < result.truth.size(); ++dot) {
    if (!scene.in_view(scene.dots.centre[dot])) continue;
    ++seen;
    // Eq. 9 equals this formula up to the distortion of the lens: 1.14 % at 22 mm, and hence 0.05 % at 4.5 mm, the
    // corner here; the radial magnification deviates by three times as much
    Vec2d const formula{-20 * scale, 10 * scale}, eq9 = result.truth.eq9_px[dot];
    EXPECT_NEAR(length(eq9 - formula) / length(formula), 0, 1.6e-3) << dot;
    // The ray result agrees within its own errors, estimated from 8 scramblings: of 200 values of Student's t with 7
    // degrees of freedom, one exceeds 6 with a probability of 10 %.
    Vec2d const off = result.truth.displacement_px[dot] - eq9, error = result.truth.displacement_error_px[dot];
    EXPECT_LT(std::abs(off.x), 6 * error.x + 1e-3 * length(formula)) << dot;
    EXPECT_LT(std::abs(off.y), 6 * error.y + 1e-3 * length(formula)) << dot;
    squares += (off.x * off.x + off.y * off.y);
    errors += (error.x * error.x + error.y * error.y);
  }
  // On average, the deviations equal the stated errors (300 squares determine their mean to a tenth), apart from the
  // deviation of the radial magnification.
  double const departing = 1.6e-3 * std::hypot(20, 10) * scale;
  EXPECT_LT(squares, 1.5 * errors + 2 * static_cast<double>(seen) * departing * departing);
  EXPECT_GT(seen, 20u);
  EXPECT_GT(all_light(result.light.reference), 0);
}

// Lenslets in front of the sensor redistribute light but block none: the same rays of dots inside the image correspond
// to the light of as many pixels, at other positions.
TEST(PlenopticRendering, SortsAllTheLightOfThePicture) {
  gladstone::Setup setup = table1_setup(96);
  setup.camera.tilt = {1e-9, 0};  // a tilt, so that both cameras use the general model
  setup.target.dots_per_32px_window = 1;
  auto const picture = [](gladstone::Setup const& of) {
    PlannedScene scene(build_scene(of));
    scene.dots.centre = {{0, 0}, {1e-3, -0.8e-3}, {-1.2e-3, 1.5e-3}};
    scene.dots.half_size = 0.1e-3;
    plan_step(scene);
    scene.plan.rays = 2048;
    return rendered_with_images(scene);
  };
  Rendering const plain = picture(setup);
  for (LensletLayout const layout : {LensletLayout::square, LensletLayout::hexagonal}) {
    setup.elements = {LensletSetup{80e-6, 900e-6, 900e-6, layout}};
    Rendering const sorted = picture(setup);
    // Light is in units of fully lit pixels, which see (1 + d / z_i)^2 less of the target without lenslets, with d the
    // distance from the lenslets to the sensor; PSFs cut at 5.5 standard deviations lose 1e-7 of the light.
    double const larger = std::pow(1 + 900e-6 / setup.imaging().image_distance, 2);
    EXPECT_NEAR(all_light(sorted.light.reference) / all_light(plain.light.reference), larger, 1e-6);
    double apart = 0;
    for (std::size_t i = 0; i < plain.light.reference.size(); ++i) {
      apart += std::abs(sorted.light.reference.data()[i] - plain.light.reference.data()[i]);
    }
    EXPECT_GT(apart, 0.5 * all_light(plain.light.reference));
    for (std::size_t dot = 0; dot < 3; ++dot) {
      EXPECT_EQ(sorted.truth.rays[dot], plain.truth.rays[dot]);
      EXPECT_EQ(sorted.truth.displacement_px[dot], Vec2d{}) << "no displacement without a medium";
    }
  }
}

}  // namespace
}  // namespace gladstone
