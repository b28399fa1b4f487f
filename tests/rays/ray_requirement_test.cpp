#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/base/parallel.h"
#include "render/light/laser_sheet.h"
#include "render/rays/rays_ladder.h"
#include "render/rays/sample_images.h"
#include "render/scene/source_sample.h"
#include "tests/scene/piv_setups.h"
#include "tests/scene/real_lens_setups.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

constexpr double mm = 1e-3;

/// White spheres of 1 um in a volume 4 mm deep, in a sheet of 60 mm, at a given exposure.
Setup exposed_setup() {
  Setup setup = piv_setup(60 * mm, 4 * mm);
  setup.camera.exposure_e = 20000;
  return setup;
}

struct Place {
  Vec3d at;
  double diameter = 1e-6;
};

/// Returns a planned scene with these particles, which move by (0.05, 0.02, 0.1) mm; a light of 1 is that of the
/// brightest particle of 1 um.
PlannedScene scene_with(Setup const& setup, std::vector<Place> const& places) {
  PlannedScene scene(build_scene(setup));
  LaserSheet<double> const sheet = laser_sheet(setup.piv->laser);
  scene.particles.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    scene.particles.place[0][i] = places[i].at;
    scene.particles.place[1][i] = places[i].at + Vec3d{0.05 * mm, 0.02 * mm, 0.1 * mm};
    scene.particles.diameter[i] = places[i].diameter;
    for (int pulse = 0; pulse < 2; ++pulse) {
      scene.particles.photons[pulse][i] = sheet.photons(scene.particles.place[pulse][i], pulse);
    }
  }
  plan_step(scene);
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  return scene;
}

Rendering render(PlannedScene scene) {
  return scene.setup.piv ? RaysRenderer().render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered,
                                                           RenderImages::yes)
                         : RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
}

std::vector<std::int64_t> planned(PlannedScene const& scene) { return render(scene).truth.rays_planned; }

/// Returns the scene with the maximum number of rays for every source.
PlannedScene of_most_rays(PlannedScene scene) {
  scene.plan.adaptive_criteria->level *= 1e-12;
  return scene;
}

/// Returns the rms error over the lit pixels of the worse frame [grey levels of the plan].
double image_error(PlannedScene const& scene, FramePair<double> const& found, FramePair<double> const& exact) {
  double worse = 0, level = scene.plan.adaptive_criteria->level;
  for (auto frame : {&FramePair<double>::reference, &FramePair<double>::flow}) {
    double square = 0;
    int lit = 0;
    for (std::size_t i = 0; i < (found.*frame).size(); ++i) {
      double const there = (exact.*frame).data()[i], off = (found.*frame).data()[i] - there;
      if (there < level) continue;
      square += off * off / (level * level);
      ++lit;
    }
    worse = std::max(worse, std::sqrt(square / std::max(lit, 1)));
  }
  return worse;
}

/// Returns the rms error of the displacements, per component [px].
double truth_error(GroundTruth const& found, GroundTruth const& exact) {
  double square = 0, count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    Vec2d const off = found.displacement_px[i] - exact.displacement_px[i];
    if (!std::isfinite(off.x)) continue;
    square += dot(off, off);
    count += 2;
  }
  return std::sqrt(square / count);
}

// n nodes integrate x^p y^q over the unit disc for p + q up to 2 sqrt(n) - 1: sixteen nodes to degree 7.
TEST(StopRule, IntegratesPolynomialsExactly) {
  BundleView choice;
  choice.seed = 5;
  for (std::uint64_t const rays : {4u, 16u, 64u}) {
    StopRule const rule(rays);
    int const degree = 2 * static_cast<int>(std::lround(std::sqrt(static_cast<double>(rays)))) - 1;
    for (int p = 0; p <= degree; ++p) {
      for (int q = 0; p + q <= degree; ++q) {
        double sum = 0;
        for (std::uint64_t j = 0; j < rays; ++j) {
          StopSamplePoint const to = sample_stop_point(rule.view(), choice, 77, j);
          sum += to.share * std::pow(to.at.x, p) * std::pow(to.at.y, q) / static_cast<double>(rays);
        }
        // x^p y^q over the disc: Gamma((p+1)/2) Gamma((q+1)/2) / (pi Gamma((p+q)/2 + 2)) for even p and q
        double const exact = p % 2 + q % 2 > 0 ? 0
                                               : std::tgamma(0.5 * (p + 1)) * std::tgamma(0.5 * (q + 1)) /
                                                     (pi * std::tgamma(0.5 * (p + q) + 2));
        EXPECT_NEAR(sum, exact, 1e-14) << rays << ": " << p << ", " << q;
      }
    }
  }
}

// The circle of confusion is 2 px wide at z of about 14 mm. A particle in focus needs four rays; out of focus, the
// number increases with the width of the circle relative to the PSF.
TEST(RayNeed, IsMoreOutOfFocus) {
  PlannedScene const scene =
      scene_with(exposed_setup(),
                 {{{0, 0, -0.05 * mm}}, {{2 * mm, 0, 3 * mm}}, {{0, 2 * mm, 12 * mm}}, {{2 * mm, 2 * mm, 25 * mm}}});
  std::vector<std::int64_t> const rays = planned(scene);
  EXPECT_EQ(rays[0], 4);
  for (std::size_t i = 1; i < rays.size(); ++i) EXPECT_GT(rays[i], rays[i - 1]) << i;
  EXPECT_LE(rays[3], static_cast<std::int64_t>(scene.plan.rays));
}

// The light is proportional to the square of the diameter: for a particle of a tenth of the diameter, the same relative
// error is a hundredth in grey levels.
TEST(RayNeed, IsLessOfDimParticles) {
  std::vector<Place> places;
  for (int i = 0; i < 12; ++i) places.push_back({{(i - 6) * mm, 1 * mm, (1 + 2 * i) * mm}});
  auto dim = places;
  for (Place& place : dim) place.diameter = 0.02e-6;
  std::vector<std::int64_t> const of_bright = planned(scene_with(exposed_setup(), places)),
                                  of_dim = planned(scene_with(exposed_setup(), dim));
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_LE(of_dim[i], of_bright[i]) << i;
  auto const sum = [](auto const& rays) { return std::accumulate(rays.begin(), rays.end(), std::int64_t{0}); };
  EXPECT_LT(sum(of_dim), sum(of_bright));
}

// The number of rays of a particle, its truth and its image are independent of other particles, to the last bit, at a
// given exposure.
TEST(RayNeed, IsIndependentOfOtherParticles) {
  gladstone::Setup setup = exposed_setup();
  setup.medium.field = GaussianBlob<double>{{{}, -0.8, 5 * mm}};
  setup.medium.thickness = 40 * mm;
  std::vector<Place> places;
  for (int i = 0; i < 40; ++i) {
    double const x = 0.37 * i - 4, y = 0.61 * (i % 9) - 3;
    places.push_back({{x * mm, y * mm, (i % 7 - 3) * mm}, (0.5 + 0.02 * i) * 1e-6});
  }
  GroundTruth const many = render(scene_with(setup, places)).truth;
  for (std::size_t const i : {0u, 17u, 38u}) {
    // the unit of light is that of the brightest particle generated by the setup, and hence the same for all scenes
    GroundTruth const one = render(scene_with(setup, {places[i]})).truth;
    EXPECT_EQ(one.rays_planned[0], many.rays_planned[i]);
    EXPECT_EQ(one.displacement_px[0], many.displacement_px[i]);
    EXPECT_EQ(one.flux[0], many.flux[i]);
  }
}

// Particles in and out of focus, through an ideal lens, a real lens and a medium: truth and images meet the required
// accuracy, compared with the maximum number of rays, and the reported number of rays is the number traced.
TEST(RayNeed, IsEnough) {
  std::vector<Place> places;
  for (int i = 0; i < 30; ++i) {
    places.push_back({{(0.4 * i - 6) * mm, (1.7 * (i % 8) - 6) * mm, (i % 5 - 2) * 2 * mm}, (0.6 + 0.02 * i) * 1e-6});
  }
  gladstone::Setup blob = exposed_setup();
  blob.medium.field = GaussianBlob<double>{{{}, -0.8, 5 * mm}};
  blob.medium.thickness = 40 * mm;
  gladstone::Setup real = exposed_setup();
  real.lens = real_lens_setup("double_gauss", 128, 8).lens;
  for (gladstone::Setup const& setup : {exposed_setup(), blob, real}) {
    PlannedScene const scene = scene_with(setup, places);
    Rendering const found = render(scene), exact = render(of_most_rays(scene));
    std::vector<std::int64_t> const& rays = found.truth.rays_planned;
    auto const [least, most] = std::minmax_element(rays.begin(), rays.end());
    if (!setup.lens.prescription) {
      EXPECT_LT(*least, *most);
    }
    EXPECT_LT(4 * found.rays, exact.rays);
    EXPECT_EQ(found.rays, frame_count * std::accumulate(rays.begin(), rays.end(), std::int64_t{0}));
    std::int64_t ended = 0;
    for (auto const& frame : found.statuses) ended += std::accumulate(frame.begin(), frame.end(), std::int64_t{0});
    EXPECT_EQ(ended, found.rays);
    EXPECT_LT(truth_error(found.truth, exact.truth), truth_tolerance_px);
    EXPECT_LT(image_error(scene, found.light, exact.light), image_tolerance_levels);
  }
}

// Rotating a cubature rule does not reveal its error due to aberrations. The stated error of the images contains it,
// since the rule is compared with the next finer one.
TEST(RayNeed, ImageErrorContainsWhatARuleLeavesOfAberrations) {
  gladstone::Setup setup = exposed_setup();
  setup.lens = real_lens_setup("achromat", 128, 8).lens;
  std::vector<Place> places;
  for (int i = 0; i < 20; ++i) places.push_back({{(0.5 * i - 5) * mm, (i % 5 - 2) * 2 * mm, (i % 3 - 1) * mm}});
  PlannedScene const scene = scene_with(setup, places);
  Rendering const found = render(scene), exact = render(of_most_rays(scene));
  double const off = image_error(scene, found.light, exact.light);
  double const stated = measure_image_error(scene, scene.plan, scene.plan.adaptive_criteria->level, all_sources(scene));
  EXPECT_GT(off, 0.01);
  EXPECT_LT(off, 3 * stated) << stated;
  EXPECT_GT(off, stated / 3) << stated;
}

// Results are bitwise identical for any number of threads, also if light is subtracted and traced again.
TEST(RayNeed, IsTheSameOnAnyNumberOfThreads) {
  gladstone::Setup setup = exposed_setup();
  setup.camera.exposure_e.reset();
  setup.medium.field = sinusoid(0.1, 6 * mm);
  setup.medium.thickness = 40 * mm;
  setup.piv->particles.amount = 60;
  auto const render_on = [&](int threads) {
    set_thread_count(threads);
    PlannedScene scene(build_scene(setup));
    plan_step(scene);
    scene.plan = plan_rays_by_tracing(scene, scene.plan);
    return render(scene);
  };
  int const before = thread_count();
  Rendering const one = render_on(1), many = render_on(3);
  set_thread_count(before);
  EXPECT_EQ(one.truth.rays_planned, many.truth.rays_planned);
  EXPECT_TRUE(std::equal(one.light.flow.begin(), one.light.flow.end(), many.light.flow.begin()));
  EXPECT_TRUE(std::equal(one.light.reference.begin(), one.light.reference.end(), many.light.reference.begin()));
}

/// Returns points of a target behind a small blob, in an image of 8 bits.
PlannedScene points_behind_blob(std::vector<Vec2d> const& at_px) {
  auto setup = table1_setup(96);
  setup.medium.field = GaussianBlob<double>{{{2 * mm, 0, 0}, -0.4, 0.8 * mm}};
  setup.medium.thickness = 10 * mm;
  setup.camera.bit_depth = 8;
  setup.camera.exposure_e = 20000;
  setup.target.dot_diameter_px = 0;
  PlannedScene scene = scene_with_dots(setup, at_px, 1);
  scene.plan.given_rays.reset();
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  return scene;
}

// If the flow deflects rays far beyond a small stop, few of them pass. Even if all of 32 rays are blocked, the dot may
// be visible; it uses more rays until some pass.
TEST(RayNeed, IsMoreOfADotThatNoRayShows) {
  auto setup = table1_setup(64);
  setup.lens.f_number = 128;
  setup.medium.field = GaussianPlume<double>{{{}, 8.0, 2 * mm}};
  setup.medium.thickness = 50 * mm;
  setup.camera.exposure_e = 20000;
  PlannedScene scene = scene_with_dots(setup, lattice(64, 6, 9), 32);
  plan_step(scene);
  auto const unseen = [](GroundTruth const& truth) {
    return std::count_if(truth.displacement_px.begin(), truth.displacement_px.end(),
                         [](Vec2d d) { return std::isnan(d.x); });
  };
  EXPECT_GT(unseen(render(scene).truth), 0);
  scene.plan.given_rays.reset();
  scene.plan = plan_rays_by_tracing(scene, scene.plan);
  EXPECT_EQ(unseen(render(scene).truth), 0);
}

// Dots that see the middle of a steep blob use more rays than others; the number and the result of each dot are the
// same alone as among others.
TEST(RayNeed, IsOfTheDotsThatNeedIt) {
  std::vector<Vec2d> at;
  for (int i = 0; i < 12; ++i) at.push_back({4 + 8.0 * i, 47.3 + 0.1 * i});
  PlannedScene const scene = points_behind_blob(at);
  Rendering const found = render(scene);
  std::vector<std::int64_t> const& rays = found.truth.rays_planned;
  auto const [least, most] = std::minmax_element(rays.begin(), rays.end());
  EXPECT_GE(*most, 4 * *least);
  for (std::size_t i = 0; i < at.size(); ++i) {
    Vec2d const error = found.truth.displacement_error_px[i];
    if (rays[i] < static_cast<std::int64_t>(scene.plan.rays)) {
      EXPECT_LE(dot(error, error), 2 * truth_tolerance_px * truth_tolerance_px) << i;
    }
    if (i % 5 != 0) continue;
    GroundTruth const alone = render(points_behind_blob({at[i]})).truth;
    EXPECT_EQ(alone.rays_planned[0], rays[i]);
    EXPECT_EQ(alone.displacement_px[0], found.truth.displacement_px[i]);
  }
  PlannedScene many = scene;
  many.plan.adaptive_criteria.reset();
  many.plan.rays = 65536;
  Rendering const exact = render(many);
  EXPECT_LT(truth_error(found.truth, exact.truth), truth_tolerance_px);
  EXPECT_LT(image_error(scene, found.light, exact.light), image_tolerance_levels);
}

// A number given in the setup applies to every source.
TEST(RayNeed, LeavesAGivenNumber) {
  gladstone::Setup setup = exposed_setup();
  setup.render.rays_per_dot = 48;
  std::vector<std::int64_t> const rays = planned(scene_with(setup, {{{0, 0, 0}}, {{0, 2 * mm, 12 * mm}}}));
  EXPECT_EQ(rays, (std::vector<std::int64_t>{48, 48}));
}

// The errors of overlapping sources add up to half a grey level, whatever their number: for k sources, each with a k-th
// of the light of the brightest pixel, the sum of the k squared errors is that of half a level.
TEST(RequiredRayAccuracy, SharesHalfALevelByLight) {
  RequiredRayAccuracy goal;
  goal.level = 1e-4;
  goal.brightest_at = 3685;
  double const brightest = goal.level * goal.brightest_at;
  for (double const k : {1.0, 7.0, 40.0}) {
    double const levels = goal.allowed(brightest / k) * (brightest / k) / goal.level;
    EXPECT_NEAR(std::sqrt(k) * levels, 0.5, 1e-12);
  }
  EXPECT_NEAR(goal.allowed(3 * brightest) * 3 * brightest / goal.level, 0.5, 1e-12);  // beyond saturation
}

}  // namespace
}  // namespace gladstone
