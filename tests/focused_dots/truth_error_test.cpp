#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "render/base/random.h"
#include "render/focused_dots/dot_cone.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

using BosSetup = Setup;  // testing::Test has a member named Setup

/// Comparison of the stated errors of dots with their deviations from many more rays.
struct Coverage {
  double share = 0;
  TableState table = TableState::made;
  double told = 0, found = 0;  ///< rms of the stated errors and of the deviations [px]
};

/// @param scene  with its number of rays
/// @param seeds  number of seeds with which it is rendered
Coverage coverage_of(PlannedScene const& scene, std::uint64_t many_rays, int seeds) {
  FocusedDotsRenderer fast;
  RaysRenderer general;
  Renderer& renderer = build_focused_dots(scene, scene.plan) ? static_cast<Renderer&>(fast) : general;
  auto const truth_of = [&](std::uint64_t rays, std::uint64_t seed) {
    PlannedScene other = scene;
    other.plan.given_rays = other.plan.rays = rays;
    other.plan.seed = repeat_seed(scene.plan.seed, seed);
    return renderer.render(other, other.plan, other.dots, RenderImages::no, RenderTheory::no);
  };
  Rendering const reference = truth_of(many_rays, 1000);
  Coverage coverage;
  coverage.table = reference.table;
  double within = 0, count = 0, told2 = 0, found2 = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    GroundTruth const truth = truth_of(scene.plan.rays, static_cast<std::uint64_t>(seed)).truth;
    for (std::size_t dot = 0; dot < truth.size(); ++dot) {
      if (std::isnan(truth.displacement_px[dot].x)) continue;  // fallback dot of the fast renderer
      Vec2d const off = truth.displacement_px[dot] - reference.truth.displacement_px[dot];
      Vec2d const error = truth.displacement_error_px[dot];
      within += (std::abs(off.x) <= error.x) + (std::abs(off.y) <= error.y);
      told2 += error.x * error.x + error.y * error.y;
      found2 += off.x * off.x + off.y * off.y;
      count += 2;
    }
  }
  coverage.share = within / count;
  coverage.told = std::sqrt(told2 / count);
  coverage.found = std::sqrt(found2 / count);
  return coverage;
}

/// Writes a volume with one wave in x and y that ends within the view, so that dots are seen through its side faces.
FieldSetup small_volume(std::string const& path) {
  constexpr int side = 24, layers = 8;
  std::ofstream file(path, std::ios::binary);
  file << "NRRD0004\ntype: double\ndimension: 3\nsizes: " << side << " " << side << " " << layers
       << "\nendian: " << (std::endian::native == std::endian::little ? "little" : "big") << "\nencoding: raw\n\n";
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        double const density = 1.225 + 0.1 * std::sin(0.5 * i + 0.3 * k) * std::cos(0.4 * j);
        file.write(reinterpret_cast<char const*>(&density), sizeof density);
      }
    }
  }
  FieldSetup field;
  field.kind = FieldKind::file;
  field.file = path;
  field.where = "test";
  field.spacing = Vec3d{0.25e-3, 0.25e-3, 0.5e-3};
  return field;
}

// If errors are independent and their standard error is known, two thirds of them are within it (0.683 for normally
// distributed errors). This must hold for all kinds of truth: the integral of a table corrected by rays (a plane of
// turbulence, a wave), a volume whose side faces require rays alone, and rays of a defocused lens. The error of the
// reference, many more rays with another seed, is less than a tenth. With about 600 components, of which the two of a
// dot and all its seeds share the reference, the standard deviation of the fraction is 2 to 3 %: 0.60 to 0.76.
TEST(TruthError, TwoThirdsOfTheDotsLieWithinIt) {
  struct Case {
    char const* name;
    FieldSetup field;
    std::uint64_t rays, many_rays;
    TableState table;
    std::function<void(BosSetup&)> change;
  };
  auto const as_is = [](BosSetup&) {};
  auto const defocused = [](BosSetup& setup) { setup.lens.focus = Focus::medium; };
  std::string const volume = testing::TempDir() + "truth_error_volume.nrrd";
  for (Case const& one :
       {Case{"late plane", dns_plane("late"), 64, 16384, TableState::made, as_is},
        {"late plane, few rays", dns_plane("late"), 16, 16384, TableState::made, as_is},
        {"early plane", dns_plane("kepeak"), 64, 16384, TableState::made, as_is},
        {"wave", sinusoid(0.05, 4e-3), 64, 16384, TableState::made, as_is},
        {"faces in view", small_volume(volume), 64, 8192, TableState::made, as_is},
        {"out of focus", sinusoid(0.05, 4e-3), 64, 8192, TableState::by_rays, defocused},
        {"out of focus, many rays", sinusoid(0.05, 4e-3), 512, 32768, TableState::by_rays, defocused}}) {
    auto setup = table1_setup(96);
    setup.medium.field = one.field;
    one.change(setup);
    PlannedScene const scene = scene_with_dots(setup, lattice(96, 6, 14), one.rays);
    Coverage const coverage = coverage_of(scene, one.many_rays, 8);
    EXPECT_EQ(coverage.table, one.table) << one.name;
    EXPECT_GE(coverage.share, 0.60) << one.name << ": stated " << coverage.told << " px, actual " << coverage.found;
    if (coverage.told < 3e-5) continue;  // rounding and the edge of the stop make the stated error too large
    EXPECT_LE(coverage.share, 0.76) << one.name << ": stated " << coverage.told << " px, actual " << coverage.found;
  }
}

// A uniform gradient deflects all rays equally, and the error of a table is about 1e-5 px, at any thickness and in any
// view. Rays alone would scatter by 0.01 px, since different rays pass the stop with and without the medium.
TEST(TruthError, AUniformGradientHasATableAtAnyThickness) {
  for (double const thickness : {10e-3, 30e-3, 50e-3, 200e-3}) {
    auto setup = table1_setup(96);
    setup.medium.field = uniform_gradient(75, 0);
    setup.medium.thickness = thickness;
    PlannedScene scene = scene_with_dots(setup, lattice(96, 5, 16), 64);
    Rendering const rendering =
        FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::no, RenderTheory::no);
    EXPECT_EQ(rendering.table, TableState::made) << thickness;
    TruthAccuracy const accuracy = truth_accuracy(rendering.truth, 1e-3);
    EXPECT_EQ(accuracy.by_table, rendering.truth.size());
    EXPECT_EQ(accuracy.above, 0u);
    EXPECT_LT(accuracy.largest_px, 3e-4) << thickness;
  }
}

// Results without scatter have an error of zero; the error of a single ray is unknown.
TEST(TruthError, IsZeroWithoutAFieldAndUnknownOfASingleRay) {
  auto const truth_with = [](std::uint64_t rays, std::function<void(BosSetup&)> const& change) {
    auto setup = table1_setup(64);
    setup.medium.field = uniform_gradient(10, 0);
    change(setup);
    PlannedScene scene = scene_with_dots(setup, lattice(64, 4, 14), rays);
    return trace_truth(scene);
  };
  GroundTruth const empty = truth_with(64, [](BosSetup& setup) { setup.medium.field = {}; });
  EXPECT_EQ(truth_accuracy(empty, 1e-3).largest_px, 0.0);
  GroundTruth const chief = truth_with(1, [](BosSetup& setup) {
    setup.lens.f_number = std::numeric_limits<double>::infinity();
    setup.target.dot_diameter_px = 0;
  });
  EXPECT_EQ(truth_accuracy(chief, 1e-3).largest_px, 0.0);
  EXPECT_EQ(truth_accuracy(chief, 1e-3).unknown, 0u);
  // rays are sent to an area larger than the stop: the only ray of some dots misses it, and these dots are invisible
  TruthAccuracy const single = truth_accuracy(truth_with(1, [](BosSetup&) {}), 1e-3);
  EXPECT_GE(single.unknown, 4u);
  EXPECT_TRUE(std::isnan(single.rms_px));
  for (std::uint64_t const rays : {2u, 3u, 5u, 7u, 9u}) {
    EXPECT_EQ(truth_accuracy(truth_with(rays, [](BosSetup&) {}), 1e-3).unknown, 0u) << rays;
  }
}

// For groups of equal weight, the error of a weighted mean is the standard deviation of the groups' means over the
// square root of their number, times Student's factor: here 1, 2, 3 and 6 with mean 3, hence sqrt(14/3/4) = 1.0801.
TEST(TruthError, IsThatOfTheMeanOfIndependentGroups) {
  RaySums of[4], all;
  TableCheck check[4], all_checked;
  double const place[4] = {1, 2, 3, 6};
  for (int i = 0; i < 4; ++i) {
    of[i].hits[0].add({0, 0}, 2.0, true);
    of[i].hits[1].add({place[i], 5}, 2.0, true);
    all += of[i];
    check[i].add({}, {{place[i] + 10, 7}, {}}, {{10, 7}, {}});
    all_checked += check[i];
  }
  double const expected = student_factor(4) * std::sqrt(14.0 / 12);
  Vec2d const rays2 = displacement_error2(of, 4, all);
  EXPECT_NEAR(std::sqrt(rays2.x), expected, 1e-12);
  EXPECT_EQ(rays2.y, 0);
  CheckErrors const errors = check_errors(check, 4, all_checked);
  EXPECT_NEAR(std::sqrt(errors.scatter2.x), expected, 1e-12);
  EXPECT_EQ(errors.scatter2.y, 0);
  EXPECT_NEAR(errors.miss2.x, 14.0 / 4, 1e-12);  // variance between the rays
}

TEST(TruthAccuracy, CountsDotsAboveALimit) {
  GroundTruth truth;
  truth.resize(4);
  double const nan = std::numeric_limits<double>::quiet_NaN();
  truth.displacement_error_px = {{3e-4, 4e-4}, {0, 2e-3}, {nan, nan}, {nan, nan}};
  truth.displacement_px[3] = {nan, nan};  // invisible dot: it has no truth, and hence no unknown error
  truth.path = {TruthPath::table, TruthPath::rays, TruthPath::rays, TruthPath::rays};
  TruthAccuracy const accuracy = truth_accuracy(truth, 1e-3);
  EXPECT_NEAR(accuracy.rms_px, std::sqrt((9e-8 + 16e-8 + 4e-6) / 4), 1e-15);
  EXPECT_EQ(accuracy.largest_px, 2e-3);
  EXPECT_EQ(accuracy.worst, 1u);
  EXPECT_EQ(accuracy.above, 1u);
  EXPECT_EQ(accuracy.above_by_rays, 1u);
  EXPECT_EQ(accuracy.unknown, 1u);
  EXPECT_EQ(accuracy.by_table, 1u);
}

}  // namespace
}  // namespace gladstone
