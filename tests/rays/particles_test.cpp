#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/rays/rays_renderer.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/two_media.h"
#include "tests/scene/piv_setups.h"
#include "tests/scene/planned_scene.h"

namespace gladstone {
namespace {

constexpr double mm = 1e-3;

/// White spheres of 1 um in a volume 1 mm deep, in a sheet of 30 mm.
Setup deep_sheet() { return piv_setup(30 * mm, 1 * mm); }

/// Returns a scene with particles at these positions, for each pulse.
PlannedScene scene_with_particles(Setup const& setup, std::vector<Vec3d> const& first, std::vector<Vec3d> const& second,
                                  std::uint64_t rays) {
  PlannedScene scene(build_scene(setup));
  LaserSheet<double> const sheet = laser_sheet(setup.piv->laser);
  scene.particles.resize(first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    scene.particles.place[0][i] = first[i];
    scene.particles.place[1][i] = second[i];
    scene.particles.diameter[i] = 1e-6;
    for (int pulse = 0; pulse < 2; ++pulse) {
      scene.particles.photons[pulse][i] = sheet.photons(scene.particles.place[pulse][i], pulse);
    }
  }
  plan_step(scene);
  scene.plan.rays = rays;
  return scene;
}

Rendering render(PlannedScene const& scene, ParticleLight light = ParticleLight::scattered,
                 RenderImages images = RenderImages::no) {
  return RaysRenderer().render_particles(scene, scene.plan, scene.particles, light, images);
}

double sum_of(Image<double> const& image) { return std::accumulate(image.begin(), image.end(), 0.0); }

/// Image distance over the distance of the particle, per pixel pitch [px/m].
double scale_at(PlannedScene const& scene, double z) {
  return scene.imaging.image_distance / (scene.setup.z_a - z) / scene.setup.camera.pixel_pitch;
}

// Photons = fluence / (h nu) times d^2 / (6 pi) at 90 degrees times the solid angle of the lens, 2 pi (1 - cos). Over
// the cone of +-0.5 degrees, the cross-section varies by odd powers, which cancel for 32 pairs of opposite rays, and by
// a square below 1e-4.
TEST(Particles, SendTheirPhotonsIntoTheLens) {
  PlannedScene scene = scene_with_particles(deep_sheet(), {{0, 0, 0}}, {{0, 0, 0}}, 64);
  LaserSetup const& laser = scene.setup.piv->laser;
  double const fluence = laser.pulse_energy / (laser.height * laser.thickness);
  double const photon = constant::planck * constant::speed_of_light / laser.wavelength;
  double const slope = 105 * mm / 8 / 2 / (750 * mm), solid = 2 * pi * (1 - 1 / std::hypot(1, slope));
  double const expected = fluence / photon * 1e-12 / (6 * pi) * solid;
  Rendering const rendering = render(scene, ParticleLight::scattered, RenderImages::yes);
  EXPECT_NEAR(rendering.truth.flux[0].x, expected, 2e-4 * expected);
  EXPECT_NEAR(rendering.truth.flux[0].y, expected, 2e-4 * expected);
  // all of it is in the image, except for the tails at which the PSF is cut off
  EXPECT_NEAR(sum_of(rendering.light.reference) * scene.photon_unit, rendering.truth.flux[0].x, 1e-5 * expected);
}

// 50 mJ in a Gaussian sheet of 40 mm by 1 mm result in 1994.71 J/m^2 in its middle. For a droplet of 1 um and m = 1.45
// in vacuum, |S1|^2 = 4.933372 and |S2|^2 = 8.263150 at 90 degrees, over k^2; the solid angle of the lens is 2.40528e-4
// sr. With the field perpendicular to the scattering plane, this is 45443 photons, and 27267 electrons at an efficiency
// of 0.6. S1 and S2 vary over the cone: 1 %.
TEST(Particles, SendThePhotonsOfMieScattering) {
  gladstone::Setup setup = deep_sheet();
  setup.medium.ambient_density = 0;
  setup.piv->particles.scattering = ParticleScattering::mie;
  setup.piv->laser.profile = SheetProfile::gaussian;
  setup.piv->laser.thickness = 1 * mm;
  for (double const field : {0.0, 90.0}) {
    setup.piv->laser.polarization = field * unit::degree;
    PlannedScene scene = scene_with_particles(setup, {{}}, {{}}, 64);
    double const photons = render(scene).truth.flux[0].x;
    double const expected = field == 0 ? 45443 : 45443 * 8.263150 / 4.933372;
    EXPECT_NEAR(photons, expected, 0.01 * expected) << field;
  }
}

// For equal sources in a plane, the solid angle of the lens is proportional to cos^3 of the field angle: its projected
// area over the squared distance. Over the lens, the cosine varies by a relative 1e-3, as an odd function.
TEST(Particles, FallOffAsCosCubed) {
  Vec3d const off{100 * mm, 50 * mm, 0};
  PlannedScene scene = scene_with_particles(deep_sheet(), {{}, off}, {{}, off}, 64);
  for (auto& photons : scene.particles.photons) photons = {1, 1};
  GroundTruth const truth = render(scene, ParticleLight::equal).truth;
  double const cosine = 0.75 / std::hypot(0.75, std::hypot(0.1, 0.05));
  EXPECT_NEAR(truth.flux[1].x / truth.flux[0].x, std::pow(cosine, 3), 2e-4);
}

// All light is in the image, for white spheres and for equal sources, except for the tails at which the PSF is cut off.
// A light of 1 is that of the brightest particle, and the fixed-point images hold 5e5 times as much. Equal sources emit
// 1e12 times the light scattered by a sphere of 1 um; in the unit of the latter, the sums would overflow.
TEST(Particles, LightThePictureByTheirFlux) {
  std::vector<Vec3d> const places{{1 * mm, 2 * mm, 0}, {-2 * mm, 1 * mm, 3 * mm}, {2.5 * mm, -1 * mm, -2 * mm}};
  for (std::uint64_t const rays : {64u, 300u}) {  // both methods: PSF by PSF, and by a grid
    PlannedScene scene = scene_with_particles(deep_sheet(), places, places, rays);
    for (ParticleLight const light : {ParticleLight::scattered, ParticleLight::equal}) {
      Rendering const rendering = render(scene, light, RenderImages::yes);
      double flux = 0, most = 0;
      for (Vec2d const photons : rendering.truth.flux) {
        flux += photons.x;
        most = std::max(most, photons.x);
      }
      double const unit = photon_unit(scene, scene.particles, light);
      if (light == ParticleLight::equal) {
        EXPECT_NEAR(unit, most, 1e-3 * most);  // cosine over the lens' cone
      }
      EXPECT_NEAR(sum_of(rendering.light.reference) * unit, flux, 1e-5 * flux);
    }
  }
}

// Chief rays of a pinhole: column and row are z_i / p times X and -Y over the distance, at any position, also outside
// the sheet.
TEST(Particles, AreProjectedByAPinhole) {
  gladstone::Setup setup = deep_sheet();
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  std::vector<Vec3d> const first{{1 * mm, 2 * mm, 0}, {-2 * mm, 1 * mm, 7 * mm}, {3 * mm, -1 * mm, -9 * mm}};
  std::vector<Vec3d> const second{{1.5 * mm, 2 * mm, 1 * mm}, {-2 * mm, 1.2 * mm, 7 * mm}, {3 * mm, -1 * mm, -3 * mm}};
  PlannedScene scene = scene_with_particles(setup, first, second, 1);
  GroundTruth const truth = render(scene).truth;
  auto const pinhole = [&](Vec3d p) {
    return Vec2d{63.5 + scale_at(scene, p.z) * p.x, 63.5 - scale_at(scene, p.z) * p.y};
  };
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LT(length(truth.reference_px[i] - pinhole(first[i])), 1e-9);
    EXPECT_LT(length(truth.displacement_px[i] - (pinhole(second[i]) - pinhole(first[i]))), 1e-9);
    EXPECT_EQ(truth.displacement_px[i], truth.particles.displacement_ambient_px[i]);
  }
}

// A particle outside the sheet sends no light; one that leaves it is visible once, and its displacement is NaN.
TEST(Particles, OutsideSheetAreInvisible) {
  gladstone::Setup setup = deep_sheet();
  setup.piv->laser.thickness = 2 * mm;
  PlannedScene scene =
      scene_with_particles(setup, {{0, 0, 0}, {1 * mm, 0, 3 * mm}}, {{0, 0, 2 * mm}, {1 * mm, 0, 3 * mm}}, 64);
  GroundTruth const truth = render(scene).truth;
  EXPECT_GT(truth.flux[0].x, 0);
  EXPECT_EQ(truth.flux[0].y, 0);
  EXPECT_TRUE(std::isfinite(truth.reference_px[0].x));
  EXPECT_TRUE(std::isnan(truth.displacement_px[0].x));
  EXPECT_EQ(truth.flux[1], Vec2d{});
  EXPECT_TRUE(std::isnan(truth.reference_px[1].x));
  EXPECT_EQ(truth.rays[1][0], 0);
}

// Elsinga, van Oudheusden & Scarano (2005): a particle inside a slab with a linear index gradient g, at a distance l
// from its face, appears at xi = -g l^2 / 2 [m] (a ray deflected by g l, seen from its middle): the position error. If
// the particle moves along the line of sight, xi changes: the velocity error (v . grad) xi. If it moves across, there
// is none. The neglected terms are angles squared, (g l)^2 = 1e-5, and 8e-5 of the cone. 512 rays add little, since the
// cone is deflected as a whole and fills the stop.
TEST(Particles, InAnIndexGradientAreDisplaced) {
  gladstone::Setup setup = deep_sheet();
  setup.medium.thickness = 40 * mm;
  double const g = 0.1;  // [1/m]
  setup.medium.field = UniformGradient<double>{{}, {g / setup.medium.gladstone_dale, 0, 0}};
  std::vector<Vec3d> const first{{0, 0, -10 * mm}, {0, 0, 5 * mm}, {0, 0, 0}};
  std::vector<Vec3d> const second{{0, 0, -8 * mm}, {1 * mm, 0, 5 * mm}, {0, 0, 1 * mm}};
  PlannedScene scene = scene_with_particles(setup, first, second, 512);
  GroundTruth const truth = render(scene).truth;
  auto const xi_px = [&](Vec3d p) {
    double const way = 20 * mm - p.z;
    return -g * way * way / 2 / setup.ambient_index() * scale_at(scene, p.z);
  };
  for (std::size_t i = 0; i < first.size(); ++i) {
    double const position_error = truth.reference_px[i].x - truth.particles.reference_ambient_px[i].x;
    EXPECT_NEAR(position_error, xi_px(first[i]), 2e-3 * std::abs(xi_px(first[i])) + 1e-4) << i;
    double const velocity_error = truth.displacement_px[i].x - truth.particles.displacement_ambient_px[i].x;
    EXPECT_NEAR(velocity_error, xi_px(second[i]) - xi_px(first[i]), 2e-3 * std::abs(xi_px(first[i]))) << i;
    EXPECT_NEAR(truth.displacement_px[i].y, 0, 2e-3) << i;
  }
  EXPECT_LT(xi_px(first[0]), -0.7);
}

// A particle at rest appears to move if the medium changes between the pulses: by xi_2 - xi_1, Elsinga's d xi / dt,
// with xi = -g l^2 / 2 as above. Light and rays are those of each pulse. The errors of the displacements by 512 rays
// are far below 2e-3 of xi, and equal the stated ones within their own scatter: a third for six components.
TEST(Particles, ApparentMotionIfMediumChanges) {
  gladstone::Setup setup = deep_sheet();
  setup.medium.thickness = 40 * mm;
  double const g[2] = {0.1, -0.05};  // [1/m]
  setup.medium.field = UniformGradient<double>{{}, {g[0] / setup.medium.gladstone_dale, 0, 0}};
  setup.medium.second_field = UniformGradient<double>{{}, {g[1] / setup.medium.gladstone_dale, 0, 0}};
  std::vector<Vec3d> const places{{0, 0, -10 * mm}, {0, 0, 5 * mm}, {0, 0, 0}};
  PlannedScene scene = scene_with_particles(setup, places, places, 512);
  RaysRenderer renderer;
  Rendering const seen =
      render_in_two_media(renderer, scene, scene.plan, scene.particles, ParticleLight::scattered, RenderImages::yes);
  for (std::size_t i = 0; i < places.size(); ++i) {
    double const way = 20 * mm - places[i].z, px = scale_at(scene, places[i].z) / setup.ambient_index();
    double const xi = g[0] * way * way / 2 * px, moved = (g[0] - g[1]) * way * way / 2 * px;
    EXPECT_NEAR(seen.truth.displacement_px[i].x, moved, 2e-3 * xi) << i;
    EXPECT_NEAR(seen.truth.displacement_px[i].y, 0, 2e-3) << i;
    EXPECT_LT(length(seen.truth.particles.displacement_ambient_px[i]), 1e-9);
    EXPECT_GT(seen.truth.displacement_error_px[i].x, 0);
    EXPECT_LT(seen.truth.displacement_error_px[i].x, 1e-3);
  }
  Rendering const unlit =
      render_in_two_media(renderer, scene, scene.plan, scene.particles, ParticleLight::scattered, RenderImages::no);
  EXPECT_TRUE(std::isnan(unlit.truth.displacement_error_px[0].x)) << "not estimated without images";
  PlannedScene second(select_second_pulse(scene));
  second.plan = scene.plan;
  Rendering const alone = render(second, ParticleLight::scattered, RenderImages::yes);
  EXPECT_TRUE(std::equal(seen.light.flow.begin(), seen.light.flow.end(), alone.light.flow.begin()));
  EXPECT_EQ(seen.truth.flux[0].y, alone.truth.flux[0].y);
  EXPECT_GT(seen.truth.displacement_px[0].x, 1);
}

// The image of a point at a distance z in front of the plane in focus is a uniform disc of diameter M D_a |z| / (Z - z)
// (exact for a thin lens). The second moment of a disc along either axis is a sixteenth of its squared diameter; the
// relative error with 4096 rays is 1e-3.
TEST(Particles, OutOfFocusLeaveADisc) {
  double const z = 10 * mm;
  gladstone::Setup setup = deep_sheet();
  setup.lens.f_number = 4;
  PlannedScene scene = scene_with_particles(setup, {{0, 0, z}, {}}, {{0, 0, z}, {}}, 4096);
  GroundTruth const truth = render(scene, ParticleLight::equal).truth;
  double const diameter = scene.imaging.image_distance / 0.75 * (105 * mm / 4) * z / (0.75 - z) / 10e-6;
  EXPECT_NEAR(truth.displacement_std_px[0].x, diameter / 4, 2e-3 * diameter / 4);
  EXPECT_LT(truth.displacement_std_px[1].x, 1e-6);
}

/// Returns the variance of an image's light along a row, about its centroid [px^2].
double variance_along_row(Image<double> const& image) {
  double sum = 0, first = 0, second = 0;
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns(); ++column) {
      sum += image(column, row);
      first += image(column, row) * column;
      second += image(column, row) * column * column;
    }
  }
  return second / sum - first / sum * (first / sum);
}

// d^2 = d_diff^2 + d_blur^2 for diameters of four standard deviations (Olsen & Adrian 2000), exact for variances: the
// image is the circle of confusion, of diameter M D |z| / (Z - z), convolved with the PSF and the pixel, whose variance
// is a twelfth. The relative error of the circle's variance with 4096 rays is 1e-3; the PSF is cut off where 4e-8 of
// its light remain.
TEST(Particles, AreAsWideAsDiffractionAndBlurTogether) {
  gladstone::Setup setup = deep_sheet();
  setup.camera.pixel_pitch = 2e-6;  // sigma is one pixel, so that the position within the pixel has no effect
  for (double const z : {0.0, 2 * mm, 6 * mm, -6 * mm}) {
    PlannedScene scene = scene_with_particles(setup, {{0, 0, z}}, {{0, 0, z}}, 4096);
    Rendering const rendering = render(scene, ParticleLight::scattered, RenderImages::yes);
    double const px = 2e-6, pupil = 105 * mm / 8, image_distance = scene.imaging.image_distance;
    double const diffraction = 4 * 0.4206042622 * image_distance / pupil * 532e-9 / px;
    double const blur = image_distance / 0.75 * pupil * std::abs(z) / (0.75 - z) / px;
    double const expected = (diffraction * diffraction + blur * blur) / 16 + 1.0 / 12;
    EXPECT_NEAR(variance_along_row(rendering.light.reference), expected, 2e-3 * blur * blur / 16 + 1e-5) << z;
  }
}

// Depth of field 4.88 ((M + 1) / M)^2 N^2 lambda (Adrian 1991): at its ends, the circle of confusion is as wide as the
// diffraction spot between its first zeros. The formula is paraxial, with a relative error of z / Z = 0.0014, and 4.88
// is 2 * 2.43934 rounded.
TEST(Particles, BlurAsMuchAsDiffractionAtTheEndsOfTheDepthOfField) {
  gladstone::Setup setup = deep_sheet();
  setup.lens.f_number = 4;
  double const M = setup.imaging().magnification;
  double const z = 0.5 * 4.88 * std::pow((M + 1) / M, 2) * 16 * 532e-9;
  PlannedScene scene = scene_with_particles(setup, {{0, 0, z}, {0, 0, -z}}, {{0, 0, z}, {0, 0, -z}}, 4096);
  GroundTruth const truth = render(scene, ParticleLight::equal).truth;
  double const spot = 2.43934 * 4 * (1 + M) * 532e-9 / 10e-6;
  for (Vec2d const deviation : truth.displacement_std_px) EXPECT_NEAR(4 * deviation.x, spot, 4e-3 * spot);
}

TEST(Particles, GiveTheSameBitsOnAnyNumberOfThreads) {
  gladstone::Setup setup = deep_sheet();
  setup.piv->particles.amount = 300;
  setup.piv->flow.flow.uniform = {30, 10, 20};
  setup.medium.field = GaussianBlob<double>{{{}, -0.8, 5 * mm}};
  setup.medium.thickness = 40 * mm;
  auto const render_on = [&](int threads) {
    set_thread_count(threads);
    PlannedScene scene(build_scene(setup));
    plan_step(scene);
    scene.plan.rays = 32;
    return render(scene, ParticleLight::scattered, RenderImages::yes);
  };
  int const before = thread_count();
  Rendering const one = render_on(1), many = render_on(3);
  set_thread_count(before);
  EXPECT_TRUE(std::equal(one.light.flow.begin(), one.light.flow.end(), many.light.flow.begin()));
  EXPECT_TRUE(std::equal(one.light.reference.begin(), one.light.reference.end(), many.light.reference.begin()));
  EXPECT_GT(sum_of(one.light.flow), 0);
  ASSERT_EQ(one.truth.size(), many.truth.size());
  for (std::size_t i = 0; i < one.truth.size(); ++i) {
    EXPECT_EQ(one.truth.flux[i], many.truth.flux[i]);
    if (std::isfinite(one.truth.displacement_px[i].x)) {
      EXPECT_EQ(one.truth.displacement_px[i], many.truth.displacement_px[i]);
    }
  }
}

}  // namespace
}  // namespace gladstone
