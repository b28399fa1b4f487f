#include "render/ideal_images/ideal_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "render/base/parallel.h"
#include "render/light/lambert_sphere.h"
#include "render/rays/rays_renderer.h"
#include "render/sensor/detector.h"
#include "tests/scene/planned_scene.h"

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

Rendering by_formula(PlannedScene const& scene, RenderImages images = RenderImages::yes) {
  return render_ideal_images(build_ideal_images(scene).value(), scene.particles, ParticleLight::scattered, images);
}

// The image is a Gaussian of the matched sigma about z_i / p (X, -Y) / (z_a - Z), integrated over pixels as differences
// of error functions. Its light is the fluence times the geometric cross-section times the fraction of all directions
// that the lens subtends. The error of the error function is 1e-12, and the PSF is cut off where 4e-8 of the light
// remain.
TEST(IdealImages, AreAGaussianOverPixels) {
  PlannedScene scene(build_scene(piv_setup()));
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
  PlannedScene scene(build_scene(piv_setup(ParticleScattering::lambert)));
  ASSERT_GT(scene.particles.size(), 500u);
  Rendering const formula = by_formula(scene);
  plan_step(scene);
  scene.plan.rays = 64;
  Rendering const rays =
      RaysRenderer().render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered, RenderImages::yes);
  EXPECT_EQ(formula.table, TableState::by_formula);
  EXPECT_EQ(rays.table, TableState::by_rays);
  auto const brightest = *std::max_element(rays.light.reference.begin(), rays.light.reference.end());
  Detector const detector(scene.setup.camera, Detector::auto_exposure(scene.setup.camera, brightest));
  double const levels = detector.pixel().electrons * detector.pixel().levels_per_electron;
  double worst = 0;
  for (auto const frame : {&FramePair<double>::reference, &FramePair<double>::flow}) {
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
  PlannedScene const scene(build_scene(piv_setup()));
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
  PlannedScene scene(build_scene(piv_setup()));
  for (auto& places : scene.particles.place) {
    for (Vec3d& place : places) place.z = 0;
  }
  EXPECT_EQ(build_ideal_images(scene)->largest_blur_px(scene.particles), 0);
  scene.particles.place[0][0].z = 0.5 * mm;
  scene.particles.photons[0][0] = 1;
  EXPECT_NEAR(build_ideal_images(scene)->largest_blur_px(scene.particles), 105.0 / 645 * 6.5625 * 0.5 / 749.5 / 5e-3,
              1e-12);
}

/// Light of one particle on the axis, in the position z, by the formula and by 4096 rays, in multiples of all its
/// light.
struct OneParticle {
  OneParticle(double f_number, double z, ParticleScattering scattering) {
    gladstone::Setup setup = piv_setup(scattering);
    setup.lens.f_number = f_number;
    setup.camera.columns = setup.camera.rows = 80;
    setup.camera.pixel_pitch = 1e-6;
    setup.piv->particles.amount = 1000;
    setup.piv->laser.thickness = 4 * mm;
    PlannedScene scene(build_scene(setup));
    scene.particles.resize(1);
    for (int pulse = 0; pulse < 2; ++pulse) {
      scene.particles.place[pulse] = {{2e-6, -3e-6, z}};
      scene.particles.photons[pulse] = {1e13};
    }
    scene.particles.diameter = {1e-6};
    auto const ideal = build_ideal_images(scene).value();
    blur = ideal.blur();
    stated_error = ideal.largest_blur_error(scene.particles);
    Rendering const drawn = by_formula(scene);
    plan_step(scene);
    scene.plan.rays = 4096;
    Rendering const traced = RaysRenderer().render_particles(scene, scene.plan, scene.particles,
                                                             ParticleLight::scattered, RenderImages::yes);
    formula = shares(drawn.light.reference);
    rays = shares(traced.light.reference);
    distance_px = length(drawn.truth.reference_px[0] - traced.truth.reference_px[0]);
    variation = variation_over_stop(scene);
    flux_ratio = drawn.truth.flux[0].x / traced.truth.flux[0].x;
  }

  /// Returns the relative change of the scattered light from the centre to the edge of the stop, along x and y.
  static Vec2d variation_over_stop(PlannedScene const& scene) {
    Vec3d const place = scene.particles.place[0][0], lens = scene.camera.aim_plane.origin;
    LightWave<double> const wave = laser_sheet(scene.setup.piv->laser).wave(place, 0);
    auto const light = [&](Vec3d at) {
      Vec3d const way = at - place, direction = way / length(way);
      if (scene.mie) return scene.mie->view().cross_section(0, direction, wave);
      return LambertSpheres<double>{scene.particles.diameter.data()}.cross_section(0, direction, wave);
    };
    auto const change = [&](Vec3d edge) {
      double const more = light(lens + edge), less = light(lens - edge);
      return (more - less) / (more + less);
    };
    double const radius = scene.imaging.entrance_pupil / 2;
    return {change({radius, 0, 0}), change({0, radius, 0})};
  }

  static std::vector<double> shares(Image<double> const& image) {
    std::vector<double> shares(image.begin(), image.end());
    double const sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share /= sum;
    return shares;
  }
  /// Largest difference of the two images, relative to the centre of the PSF.
  double difference() const {
    double largest = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) largest = std::max(largest, std::abs(formula[i] - rays[i]));
    return largest * 2 * std::numbers::pi * blur.sigma * blur.sigma;
  }
  /// Variance of the image by formula along its rows [px^2].
  double variance() const {
    double first = 0, second = 0;
    for (std::size_t i = 0; i < formula.size(); ++i) {
      double const x = static_cast<double>(i % 80) - 39.5;
      first += formula[i] * x;
      second += formula[i] * x * x;
    }
    return second - first * first;
  }

  DefocusBlur blur;
  Vec2d variation;
  double stated_error = 0, distance_px = 0, flux_ratio = 0;
  std::vector<double> formula, rays;
};

// Out of focus, images by formula differ from those of rays by (r / (2 sigma))^4 / 3 of the PSF's centre (DefocusBlur),
// up to the next term of this series, a share of 2 (r / (2 sigma))^2, and the mean over pixels of up to a standard
// deviation. If the light changes linearly over the stop by a share g from its centre to its edge, the centroid of the
// disc is r g / 4 off its centre: the mean of x (1 + g x) over a unit disc. A shift s changes the image by exp(-1/2) s
// / sigma. The remainder of 7e-4 is the scatter of the rays and the grid on which many rays are collected. The variance
// of an image is sigma^2 + r^2 / 4 + 1/12.
TEST(IdealImages, AreBlurredAsThoseOfRays) {
  for (ParticleScattering const scattering : {ParticleScattering::lambert, ParticleScattering::mie}) {
    for (double const f_number : {16.0, 8.0, 5.6, 4.0}) {
      for (double const z : {-0.5 * mm, 0.2 * mm, 0.5 * mm, 1 * mm}) {
        OneParticle const one(f_number, z, scattering);
        double const sigma = one.blur.sigma, r = one.blur.radius(z), half = r / (2 * sigma);
        if (half > 0.7) continue;  // beyond, the series does not converge
        SCOPED_TRACE(testing::Message() << "f/" << f_number << ", z = " << z << ", r / (2 sigma) = " << half);
        double const expected = std::pow(half, 4) / 3, shift = r * length(one.variation) / 4;
        EXPECT_NEAR(one.stated_error, expected, 1e-12);
        EXPECT_LT(one.difference(), expected + 0.61 * shift / sigma + 7e-4);
        if (half > 0.3) {
          EXPECT_GT(one.difference(), 0.3 * expected);
        }
        EXPECT_NEAR(one.variance(), sigma * sigma + r * r / 4 + 1.0 / 12, 1e-4);
        EXPECT_NEAR(one.distance_px, shift, 0.1 * shift + 1e-4);
        EXPECT_NEAR(one.flux_ratio, 1, scattering == ParticleScattering::lambert ? 1e-3 : 1e-2);
      }
    }
  }
}

// The circle of confusion in front of and behind the plane in focus: M D |z| / (2 (Z - z)), here with M = 105 / 645.
TEST(IdealImages, WidenByTheCircleOfConfusion) {
  PlannedScene const scene(build_scene(piv_setup(ParticleScattering::lambert)));
  DefocusBlur const blur = build_ideal_images(scene)->blur();
  for (double const z : {-2 * mm, 0.0, 0.5 * mm}) {
    double const r = 105.0 / 645 * 6.5625 * mm / 2 * std::abs(z) / (750 * mm - z) / 5e-6;
    EXPECT_NEAR(blur.radius(z), r, 1e-12);
    EXPECT_NEAR(blur.width(z), std::sqrt(blur.sigma * blur.sigma + r * r / 4), 1e-12);
  }
  PlannedScene const neglected(build_scene(piv_setup()));
  EXPECT_EQ(build_ideal_images(neglected)->blur().width(2 * mm), neglected.spot_sigma_px());
}

TEST(IdealImages, HaveOneDoor) {
  EXPECT_EQ(reason_against_ideal_images(piv_setup()), "");
  auto const reason = [](auto const& change) {
    gladstone::Setup setup = piv_setup();
    change(setup);
    return reason_against_ideal_images(setup);
  };
  EXPECT_NE(reason([](gladstone::Setup& s) { s.piv.reset(); }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.medium.field = Sinusoid<double>::wave(0.1, 4e-3); }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.medium.second_field = FieldSetup{}; }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.camera.tilt = {0.1, 0}; }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.elements.emplace_back(OpticalWindow{}); }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.lens.focus = Focus::distance; }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.lens.f_number = std::numeric_limits<double>::infinity(); }), "");
  EXPECT_NE(reason([](gladstone::Setup& s) { s.lens.spot = SpotModel::airy; }), "");
}

}  // namespace
}  // namespace gladstone
