#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "render/base/random.h"
#include "render/planning.h"
#include "render/rays/rays_renderer.h"
#include "render/rays/sample_images.h"
#include "render/render.h"
#include "render/scene/side_faces.h"
#include "render/scene/source_sample.h"
#include "tests/scene/piv_setups.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// The set-up of Table 1 with a volume of 8.8 x 10.4 x 7.2 mm, one side face of which is in view.
PlannedScene volume_in_view(std::uint64_t rays) {
  FieldSetup field;
  field.kind = FieldKind::file;
  field.file = testing::TempDir() + "volume_in_view.nrrd";
  field.where = "test";
  field.spacing = Vec3d{0.8e-3, 0.8e-3, 0.8e-3};
  field.center = {2.8e-3, 0, 0};
  std::ofstream file(field.file, std::ios::binary);
  file << "NRRD0004\ntype: float\ndimension: 3\nsizes: 12 14 10\nendian: little\nencoding: raw\n\n";
  for (int i = 0; i < 12 * 14 * 10; ++i) {
    auto const number =
        static_cast<float>(1.2 + 0.05 * std::sin(0.7 * (i % 12) + 0.4 * (i / 12 % 14) + 0.5 * (i / 168)));
    file.write(reinterpret_cast<char const*>(&number), sizeof number);
  }
  file.close();
  gladstone::Setup setup = table1_setup(96);
  setup.medium.field = field;
  return scene_with_dots(setup, lattice(96, 8, 11), rays);
}

Rendering render(PlannedScene const& scene) {
  return cpu().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::yes);
}

// For a source that is not listed, either all straight rays to the pupil cross the volume from face to face, or none
// does.
TEST(SideFaces, CutTheConesOfThoseListedAlone) {
  PlannedScene const scene = volume_in_view(32);
  std::vector<std::size_t> const listed = sources_at_side_faces(scene, scene.plan, scene.dots);
  EXPECT_GT(listed.size(), 8u);
  EXPECT_LE(listed.size(), scene.dots.centre.size() / 2);
  Bounds<double> const box = std::visit([](auto const& medium) { return medium.bounds(); }, scene.medium.view);
  for (std::size_t dot = 0; dot < scene.dots.centre.size(); ++dot) {
    if (std::binary_search(listed.begin(), listed.end(), dot)) continue;
    int crossing = 0;
    for (std::uint64_t ray = 0; ray < 256; ++ray) {
      auto const at = [&](std::uint64_t k, double radius) {
        double const turn = 6.283185307179586 * to_unit(random_bits(1, RandomStream::pupil, dot, 4 * ray + k));
        double const r = radius * std::sqrt(to_unit(random_bits(1, RandomStream::pupil, dot, 4 * ray + k + 1)));
        return Vec2d{r * std::cos(turn), r * std::sin(turn)};
      };
      Vec2d const from = scene.dots.centre[dot] + at(0, scene.dots.half_size);
      Vec2d const to = at(2, scene.imaging.entrance_pupil / 2);
      bool inside = true;
      for (double const z : {box.low.z, box.high.z}) {
        double const share = (z + scene.setup.z_d) / scene.setup.z_b();
        Vec2d const p = (1 - share) * from + share * to;
        inside = inside && p.x > box.low.x && p.x < box.high.x && p.y > box.low.y && p.y < box.high.y;
      }
      crossing += inside;
    }
    EXPECT_TRUE(crossing == 0 || crossing == 256) << dot << ": " << crossing;
  }
  // a closed form has no side faces
  gladstone::Setup setup = table1_setup(96);
  setup.medium.field = sinusoid(0.1, 4e-3);
  PlannedScene const wave = scene_with_dots(setup, lattice(96, 8, 11), 32);
  EXPECT_TRUE(sources_at_side_faces(wave, wave.plan, wave.dots).empty());
}

// Dots whose cones are cut by a face are traced ray by ray, with separate rays: the truth is correct within its stated
// error, and there is no light where there are no rays. (A smooth fit to 32 rays had errors of three quarters of full
// scale in single pixels.)
TEST(SideFaces, DotsThereAreRightWithRaysOfTheirOwn) {
  PlannedScene scene = volume_in_view(32);
  scene.plan.given_rays.reset();
  scene.plan.adaptive_criteria = AdaptiveRayCriteria{1e-7, 3685};  // as many rays as are allowed
  auto const most = static_cast<std::int64_t>(max_rays_per_source(scene, scene.plan));
  // The bounds below are those of 8192 rays. Errors of a cone that is cut in two decrease between 1/sqrt(rays) and
  // 1/rays, so that with fewer rays they are larger by at most the ratio of the numbers.
  double const fewer = std::max(1.0, 8192.0 / static_cast<double>(most));
  std::vector<std::size_t> const listed = sources_at_side_faces(scene, scene.plan, scene.dots);
  std::vector<std::size_t> const left =
      FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::no, RenderTheory::no).left;
  EXPECT_TRUE(std::includes(left.begin(), left.end(), listed.begin(), listed.end()));
  EXPECT_LE(left.size(), scene.dots.centre.size() / 2);
  Rendering const found = render(scene);
  PlannedScene exact = scene;
  exact.plan.adaptive_criteria.reset();
  exact.plan.rays = 65536;
  exact.plan.seed = 99;
  Rendering const plain = RaysRenderer().render(exact, exact.plan, exact.dots, RenderImages::yes, RenderTheory::yes);
  for (std::size_t dot = 0; dot < scene.dots.centre.size(); ++dot) {
    bool const at_face = std::binary_search(left.begin(), left.end(), dot);
    // a dot outside the volume requires no ray
    std::int64_t const planned = found.truth.rays_planned[dot];
    EXPECT_TRUE(at_face ? planned == most : planned == 32 || planned == 0) << dot << ": " << planned;
    Vec2d const off = found.truth.displacement_px[dot] - plain.truth.displacement_px[dot];
    Vec2d const one = found.truth.displacement_error_px[dot], other = plain.truth.displacement_error_px[dot];
    EXPECT_LE(std::abs(off.x), 4 * std::hypot(one.x, other.x) + 1e-4) << dot;
    EXPECT_LE(std::abs(off.y), 4 * std::hypot(one.y, other.y) + 1e-4) << dot;
    if (at_face) {
      EXPECT_LT(length(one), 2e-3 * fewer) << dot;
    }
    EXPECT_NEAR(length(found.truth.eq9_px[dot] - plain.truth.eq9_px[dot]), 0, 1e-8) << dot;
  }
  // rays without a table scatter by half a level with 65,536 rays (test of RaysRenderer), and by at most 8 times that
  // with an eighth of them; no dot of the right half is at the face, where 32 rays correct a smooth field
  auto const rms_levels = [&](Image<double> const& one, Image<double> const& other, int begin, int end) {
    double const level = *std::max_element(other.begin(), other.end()) / (0.9 * 4095);
    double square = 0, lit = 0, largest = 0;
    for (int row = 0; row < one.rows(); ++row) {
      for (int column = begin; column < end; ++column) {
        if (other(column, row) < level) continue;
        double const off = std::abs(one(column, row) - other(column, row)) / level;
        square += off * off;
        ++lit;
        largest = std::max(largest, off);
      }
    }
    EXPECT_LT(largest, 0.02 * 4095 * fewer);
    return std::sqrt(square / lit);
  };
  EXPECT_LT(rms_levels(found.light.flow, plain.light.flow, 0, 48), 4.5 * fewer);
  EXPECT_LT(rms_levels(found.light.flow, plain.light.flow, 48, 96), 0.7);
  EXPECT_LT(rms_levels(found.light.reference, plain.light.reference, 0, 96), 4.5 * fewer);
}

// Each ray counts once: the number that reaches the sensor plane is that of the dots, and the total is the number
// traced, although the fast renderer also traced rays of the dots that it rejected.
TEST(SideFaces, RaysThereAreCountedOnce) {
  PlannedScene const scene = volume_in_view(32);
  Rendering const found = render(scene);
  std::int64_t traced = 0;
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    auto const& statuses = found.statuses[frame];
    std::int64_t of_dots = 0;
    for (auto const& rays : found.truth.rays) of_dots += rays[frame];
    EXPECT_EQ(of_dots, statuses[static_cast<std::size_t>(RayStatus::alive)] +
                           statuses[static_cast<std::size_t>(RayStatus::missed_sensor)]);
    for (std::int64_t const count : statuses) traced += count;
  }
  EXPECT_EQ(traced, found.rays);
}

// The light of dark dots is subtracted from that of white paper once.
TEST(SideFaces, DarkDotsAreWhiteLessBright) {
  PlannedScene scene = volume_in_view(32);
  Rendering const bright = render(scene);
  scene.plan.polarity = Polarity::dark;
  Rendering const dark = render(scene);
  Image<double> const white = render_white_light(scene);
  for (std::size_t i = 0; i < white.size(); ++i) {
    EXPECT_NEAR(dark.light.flow.data()[i], white.data()[i] - bright.light.flow.data()[i], 1e-13);
  }
}

// With rays_per_dot = "auto", these dots take as many rays as each requires, more than the others, and reach the goal
// of the truth; the others are rendered as if they were alone.
TEST(SideFaces, AutoTakesTheRaysThatDotsThereRequire) {
  PlannedScene scene = volume_in_view(1);
  scene.setup.render.rays_per_dot.reset();
  scene.plan = plan_rendering(scene);
  EXPECT_TRUE(scene.plan.adaptive_criteria);
  EXPECT_LE(scene.plan.rays, 256u);
  std::vector<std::size_t> const listed = sources_at_side_faces(scene, scene.plan, scene.dots);
  Rendering const found = render(scene);
  Rendering const alone =
      FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::no, RenderTheory::no);
  std::int64_t most = 0;
  for (std::size_t dot = 0; dot < found.truth.size(); ++dot) {
    if (std::binary_search(listed.begin(), listed.end(), dot)) {
      most = std::max(most, found.truth.rays_planned[dot]);
      EXPECT_LE(length(found.truth.displacement_error_px[dot]), std::sqrt(2.0) * truth_tolerance_px) << dot;
    } else if (!std::binary_search(alone.left.begin(), alone.left.end(), dot)) {
      EXPECT_EQ(found.truth.displacement_px[dot], alone.truth.displacement_px[dot]) << dot;
    }
  }
  EXPECT_GE(most, 4 * static_cast<std::int64_t>(scene.plan.rays));
}

/// The dots at side faces alone, as the general renderer traces them with a given number of rays.
PlannedScene dots_at_faces(std::uint64_t rays) {
  PlannedScene scene = volume_in_view(rays);
  scene.dots = select_dots(scene.dots, sources_at_side_faces(scene, scene.plan, scene.dots));
  return scene;
}

double largest(Image<double> const& image) { return *std::max_element(image.begin(), image.end()); }

// With a given number of rays the errors of these dots are measured in truth and images: 32 rays of a cone that is cut
// in two scatter by more than the goals, and 2048 rays by a factor of sqrt(64) = 8 less, or more. Scatter from so few
// dots is accurate to about a tenth; half of the factor is required.
TEST(SideFaces, AreMeasuredWithAGivenNumber) {
  auto const measured = [](std::uint64_t rays) {
    PlannedScene const scene = dots_at_faces(rays);
    Rendering const found = RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
    double const level = largest(found.light.flow) / (0.9 * 4095);
    return std::pair{truth_accuracy(found.truth, truth_tolerance_px).rms_px,
                     measure_image_error(scene, scene.plan, level, all_sources(scene))};
  };
  auto const few = measured(32), many = measured(2048);
  EXPECT_GT(few.first, truth_tolerance_px);
  EXPECT_GT(few.second, 10 * image_tolerance_levels);
  EXPECT_LT(many.first, few.first / 4);
  EXPECT_LT(many.second, few.second / 4);
}

// The stated errors of the images apply: images of these dots with 32 rays are compared with those of other random
// rays, which scatter equally. A factor of two is allowed for the choice of illuminated pixels.
TEST(SideFaces, ImagesAreOffByTheStatedError) {
  PlannedScene const scene = dots_at_faces(32);
  PlannedScene other = scene;
  other.plan.seed = 99;
  RaysRenderer renderer;
  Image<double> const
      one = renderer.render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no).light.flow,
      two = renderer.render(other, other.plan, other.dots, RenderImages::yes, RenderTheory::no).light.flow;
  double const level = largest(two) / (0.9 * 4095);
  double square = 0, lit = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    double const a = one.data()[i], b = two.data()[i];
    if (a + b < 2 * level) continue;
    square += (a - b) * (a - b) / (2 * level * level);
    ++lit;
  }
  double const found = std::sqrt(square / lit),
               stated = measure_image_error(scene, scene.plan, level, all_sources(scene));
  EXPECT_GT(stated, found / 2);
  EXPECT_LT(stated, found * 2);
}

// Particles far outside the view are not traced: images and the truth of all others are identical, bit by bit. A plume
// of light gas deflects rays by some pixels.
TEST(ParticlesNearView, AreAllThatFramesShow) {
  gladstone::Setup setup = piv_setup(2e-3, 1e-3);
  setup.camera.columns = setup.camera.rows = 64;
  setup.lens.f_number = 4;
  setup.view_margin_px = 16;
  setup.piv->particles.amount = 400;
  setup.piv->particles.volume = Vec3d{24e-3, 24e-3, 1e-3};
  setup.render.rays_per_dot = 16;
  GaussianBlob<double> plume;
  plume.amplitude = -0.6;
  plume.radius = 4e-3;
  setup.medium.field = plume;
  setup.medium.thickness = 20e-3;
  PlannedScene scene(build_scene(setup));
  scene.plan = plan_rendering(scene);
  Rendering const near =
      cpu().render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered, RenderImages::yes);
  Rendering const every =
      RaysRenderer().render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered, RenderImages::yes);
  EXPECT_TRUE(std::equal(near.light.reference.begin(), near.light.reference.end(), every.light.reference.begin()));
  EXPECT_TRUE(std::equal(near.light.flow.begin(), near.light.flow.end(), every.light.flow.begin()));
  std::size_t skipped = 0;
  for (std::size_t i = 0; i < near.truth.size(); ++i) {
    if (near.truth.rays_planned[i] == 0) {
      ++skipped;
      Vec2d const at = every.truth.reference_px[i];
      EXPECT_FALSE(at.x > -16 && at.x < 79 && at.y > -16 && at.y < 79) << i;
      continue;
    }
    if (std::isnan(every.truth.displacement_px[i].x)) continue;
    EXPECT_EQ(near.truth.displacement_px[i], every.truth.displacement_px[i]);
    EXPECT_EQ(near.truth.flux[i], every.truth.flux[i]);
  }
  EXPECT_GT(skipped, near.truth.size() / 2);  // the volume is six times as wide as the view
  EXPECT_LT(near.rays, every.rays / 2);
}

// The small-angle theory is integrated along the same number of rays for every dot, in panels as long as a step: its
// time is proportional to the number of dots and, for whole panels, to the inverse of the step. A third of a
// microsecond per panel and ray is the maximum for three samples, and 100 the minimum number of rays per dot.
TEST(RenderSeconds, CountTheoryOfEveryDot) {
  GaussianBlob<double> plume;
  plume.amplitude = -0.5;
  plume.radius = 5e-3;
  gladstone::Setup setup = table1_setup(96);
  setup.medium.field = plume;
  setup.medium.thickness = 32e-3;
  setup.medium.step_mm = 1.0;
  for (RenderMethod const method : {RenderMethod::focused_dots, RenderMethod::rays}) {
    setup.render.method = method;
    auto const of_theory = [&](int per_side, double step_share) {
      PlannedScene scene = scene_with_dots(setup, lattice(96, per_side, 80.0 / per_side), 16);
      scene.plan.step *= step_share;
      double const without = render_seconds(scene, scene.plan, RenderTheory::no);
      EXPECT_GT(without, 0);
      return render_seconds(scene, scene.plan, RenderTheory::yes) - without;
    };
    double const few = of_theory(4, 1);
    EXPECT_GT(few, 16 * 100 * 32 * 10e-9);
    EXPECT_LT(few, 16 * 1e4 * 32 * 0.33e-6);
    EXPECT_NEAR(of_theory(8, 1) / few, 4, 1e-9);
    EXPECT_GT(of_theory(4, 0.5) / few, method == RenderMethod::rays ? 1.3 : 1.9);
  }
}

}  // namespace
}  // namespace gladstone
