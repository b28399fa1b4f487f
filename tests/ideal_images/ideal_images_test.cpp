#include "render/ideal_images/ideal_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "render/base/parallel.h"
#include "render/rays/ray_planning.h"
#include "render/rays/rays_renderer.h"
#include "render/sensor/detector.h"

namespace gladstone {
namespace {

constexpr double mm = 1e-3;

/// White spheres in a plane sheet, imaged by a lens of 105 mm at f/16 from 750 mm; the standard deviation of the PSF is
/// 0.83 px at a pixel pitch of 5 um.
Setup piv_setup(ParticleScattering scattering = ParticleScattering::gaussian) {
  Setup setup;
  setup.camera.columns = 160;
  setup.camera.rows = 200;
  setup.camera.pixel_pitch = 5e-6;
  setup.camera.bit_depth = 12;
  setup.lens.f_number = 16;
  setup.z_d = 0;
  PivSetup piv;
  piv.laser.profile = SheetProfile::top_hat;
  piv.particles.scattering = scattering;
  piv.particles.amount = 600;
  piv.particles.volume = Vec3d{5 * mm, 7 * mm, 1e-7};
  piv.flow.flow.uniform = {10, -4, 0};
  setup.piv = piv;
  return setup;
}

Rendering by_formula(Scene const& scene, RenderImages images = RenderImages::yes) {
  return render_ideal_images(ideal_images(scene).value(), scene.particles, ParticleLight::scattered, images);
}

// The image is a Gaussian of the matched sigma about z_i / p (X, -Y) / (z_a - Z), integrated over pixels as differences
// of error functions. Its light is the fluence times the geometric cross-section times the fraction of all directions
// that the lens subtends. The error of the error function is 1e-12, and the PSF is cut off where 4e-8 of the light
// remain.
TEST(IdealImages, AreAGaussianOverPixels) {
  Scene scene = build_scene(piv_setup());
  Vec3d const first{0.3 * mm, -0.7 * mm, 0.4 * mm}, second{0.5 * mm, -0.8 * mm, -0.2 * mm};
  scene.particles.resize(1);
  scene.particles.place[0] = {first};
  scene.particles.place[1] = {second};
  scene.particles.photons[0] = {3e13};
  scene.particles.photons[1] = {5e13};
  scene.particles.diameter = {2e-6};
  Rendering const rendering = by_formula(scene);
  double const image_distance = 1 / (1 / 0.105 - 1 / 0.75),
               sigma = 0.4206042622 * image_distance / (0.105 / 16) * 532e-9 / 5e-6;
  auto const check = [&](Vec3d p, double photons, double flux, Image<double> const& image) {
    double const scale = image_distance / (0.75 - p.z) / 5e-6;
    Vec2d const at{79.5 + scale * p.x, 99.5 - scale * p.y};
    double const far2 = p.x * p.x + p.y * p.y + (0.75 - p.z) * (0.75 - p.z), cosine = (0.75 - p.z) / std::sqrt(far2);
    double const lens = std::numbers::pi / 4 * std::pow(0.105 / 16, 2) * cosine / far2;
    EXPECT_NEAR(flux, photons * 4e-12 / 16 * lens, 1e-12 * flux);
    auto const share = [&](double pixel, double middle) {
      double const width = sigma * std::sqrt(2.0);
      return 0.5 * (std::erf((pixel + 0.5 - middle) / width) - std::erf((pixel - 0.5 - middle) / width));
    };
    for (int row = 0; row < image.rows(); ++row) {
      for (int column = 0; column < image.columns(); ++column) {
        double const expected = flux / scene.photon_unit * share(column, at.x) * share(row, at.y);
        EXPECT_NEAR(image(column, row), expected, 1e-8 * flux / scene.photon_unit) << column << ' ' << row;
      }
    }
    return at;
  };
  Vec2d const a = check(first, 3e13, rendering.truth.flux[0].x, rendering.light.reference);
  Vec2d const b = check(second, 5e13, rendering.truth.flux[0].y, rendering.light.flow);
  EXPECT_LT(length(rendering.truth.reference_px[0] - a), 1e-10);
  EXPECT_LT(length(rendering.truth.displacement_px[0] - (b - a)), 1e-10);
}

// For a particle in the plane in focus, all rays meet at the image position of the formula, and their light equals that
// of the lens' centre up to the square of the lens' half angle, (3.3 / 750)^2 = 2e-5. The images differ by less than
// half a grey level at 12 bits, and the truth by rounding only.
TEST(IdealImages, EqualThoseOfRaysInFocus) {
  Scene scene = build_scene(piv_setup(ParticleScattering::lambert));
  ASSERT_GT(scene.particles.size(), 500u);
  Rendering const formula = by_formula(scene);
  scene = with_step(scene, determine_step_by_tracing(scene));
  scene.rays_per_dot = 64;
  Rendering const rays =
      RaysRenderer().render_particles(scene, scene.particles, ParticleLight::scattered, RenderImages::yes);
  EXPECT_EQ(formula.table, TableState::by_formula);
  EXPECT_EQ(rays.table, TableState::by_rays);
  auto const brightest = *std::max_element(rays.light.reference.begin(), rays.light.reference.end());
  Detector const detector(scene.setup.camera, Detector::auto_exposure(scene.setup.camera, brightest));
  double const levels = detector.pixel().electrons * detector.pixel().levels_per_electron;
  double worst = 0;
  for (auto const frame : {&LightPair::reference, &LightPair::flow}) {
    Image<double> const &a = formula.light.*frame, &b = rays.light.*frame;
    for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, levels * std::abs(a.data()[i] - b.data()[i]));
  }
  EXPECT_LT(worst, 0.5);
  EXPECT_GT(levels * brightest, 3000);
  for (std::size_t i = 0; i < scene.particles.size(); ++i) {
    if (!(rays.truth.flux[i].x > 0)) continue;
    EXPECT_NEAR(formula.truth.flux[i].x, rays.truth.flux[i].x, 1e-4 * rays.truth.flux[i].x);
    EXPECT_LT(length(formula.truth.reference_px[i] - rays.truth.reference_px[i]), 1e-3);
  }
}

// Sums within a band of rows have a fixed order, whichever thread computes them.
TEST(IdealImages, AreTheSameBitsOnAnyNumberOfThreads) {
  Scene const scene = build_scene(piv_setup());
  int const before = thread_count();
  set_thread_count(1);
  Rendering const one = by_formula(scene);
  set_thread_count(3);
  Rendering const many = by_formula(scene);
  set_thread_count(before);
  EXPECT_TRUE(std::equal(one.light.flow.begin(), one.light.flow.end(), many.light.flow.begin()));
  EXPECT_GT(std::accumulate(one.light.flow.begin(), one.light.flow.end(), 0.0), 0);
  // A particle that is illuminated at one pulse only has no displacement. The images of some particles are outside the
  // sensor, which does not matter here.
  for (std::size_t i = 0; i < one.truth.size(); ++i) {
    bool const both = one.truth.flux[i].x > 0 && one.truth.flux[i].y > 0;
    EXPECT_EQ(std::isfinite(one.truth.displacement_px[i].x), both);
  }
}

// Circle of confusion M D z / (Z - z) for z = 0.5 mm at f/16: 0.1628 * 6.5625 mm * 0.5 / 749.5 over 5 um.
TEST(IdealImages, SayWhatBlurTheyLeaveOut) {
  Scene scene = build_scene(piv_setup());
  for (auto& places : scene.particles.place) {
    for (Vec3d& place : places) place.z = 0;
  }
  EXPECT_EQ(ideal_images(scene)->largest_blur_px(scene.particles), 0);
  scene.particles.place[0][0].z = 0.5 * mm;
  scene.particles.photons[0][0] = 1;
  EXPECT_NEAR(ideal_images(scene)->largest_blur_px(scene.particles), 105.0 / 645 * 6.5625 * 0.5 / 749.5 / 5e-3, 1e-9);
}

TEST(IdealImages, HaveOneDoor) {
  using testing::HasSubstr;
  EXPECT_EQ(reason_against_ideal_images(piv_setup()), "");
  auto const reason = [](auto const& change) {
    gladstone::Setup setup = piv_setup();
    change(setup);
    return reason_against_ideal_images(setup);
  };
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.piv.reset(); }), HasSubstr("only particles"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.medium.field = Sinusoid<double>::wave(0.1, 4e-3); }),
              HasSubstr("medium deflects rays"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.medium.second_field = FieldSetup{}; }),
              HasSubstr("medium deflects rays"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.camera.tilt = {0.1, 0}; }), HasSubstr("not an ideal thin lens"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.elements.emplace_back(OpticalWindow{}); }),
              HasSubstr("not an ideal thin lens"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.lens.focus = Focus::distance; }),
              HasSubstr("not focused on the sheet"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.lens.f_number = std::numeric_limits<double>::infinity(); }),
              HasSubstr("no stop"));
  EXPECT_THAT(reason([](gladstone::Setup& s) { s.lens.spot = SpotModel::airy; }), HasSubstr("not Gaussian"));
}

}  // namespace
}  // namespace gladstone
