#include "analysis/vectors/joint_detection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/convention_report.h"

namespace gladstone {
namespace {

using Flow = std::function<Vec2d(Vec2d)>;

Vec2d uniform(Vec2d) { return {0.3, -0.3}; }

/// Rotation about the middle of the image: exchanged frames look like axes that point upwards.
Vec2d vortex(Vec2d p) {
  Vec2d const r{p.x - 127.5, p.y - 127.5};
  double const swirl = 4.0 * std::exp(-dot(r, r) / 3600.0) / 60.0;
  return {-swirl * r.y, swirl * r.x};
}

/// Rotation about another point, with a stretch along x.
Vec2d off_centre(Vec2d p) {
  Vec2d const turned = vortex(p + Vec2d{40.0, -25.0});
  return {turned.x + 0.004 * p.x, turned.y};
}

/// Vectors that a code with the mistake `change` writes for the truth.
VectorsWithTruth written(Flow const& truth, Flow const& change, Vec2d shift_px = {}) {
  VectorsWithTruth written{{}, truth, 256};
  written.file.format = "test";
  for (int row = 0; row < 15; ++row) {
    for (int column = 0; column < 15; ++column) {
      Vec2d const p{15.5 + 16.0 * column, 15.5 + 16.0 * row};
      written.file.field.position_px.push_back(p + shift_px);
      written.file.field.displacement_px.push_back(change(truth(p)));
    }
  }
  return written;
}

Vec2d same(Vec2d d) { return d; }

/// Matches a reason: the frames were exchanged.
auto frames_exchanged() {
  VectorConventions reading;
  reading.swapped = true;
  return testing::Truly([reading](MistakeReason const& one) { return same_axes(one.interpretation, reading); });
}

void expect_near(Vec2d measured, Vec2d expected, double tolerance) {
  EXPECT_NEAR(measured.x, expected.x, tolerance);
  EXPECT_NEAR(measured.y, expected.y, tolerance);
}

TEST(DetectCommonConventions, UsesDecisiveCasesOnly) {
  Flow const negative = [](Vec2d d) { return -d; };
  // the vortex alone: negative vectors are explained by exchanged frames and by both axes reversed
  CommonConventions const alone = detect_common_conventions({written(vortex, negative)});
  EXPECT_TRUE(alone.ambiguous);
  ASSERT_GT(alone.mistake.reasons.size(), 1u);
  EXPECT_THAT(alone.mistake.reasons.front(), frames_exchanged());
  EXPECT_EQ(alone.mistake.conventions, "") << "one file alone does not determine the correction";
  CommonConventions const both =
      detect_common_conventions({written(uniform, negative), written(vortex, negative), written(off_centre, negative)});
  EXPECT_FALSE(both.ambiguous);
  EXPECT_THAT(both.mistake.reasons, testing::ElementsAre(frames_exchanged()));
  EXPECT_EQ(both.mistake.conventions, "y-down,v-down,frames-exchanged,offset=0");
  EXPECT_NE(both.decisive, 0u) << "a uniform displacement does not distinguish exchanged frames from exchanged columns";
}

TEST(DetectCommonConventions, OneAsymmetricCaseIsDecisive) {
  CommonConventions const symmetric = detect_common_conventions({written(vortex, same)});
  EXPECT_FALSE(symmetric.mistake.found());
  EXPECT_TRUE(symmetric.ambiguous);
  CommonConventions const sure = detect_common_conventions({written(vortex, same), written(off_centre, same)});
  EXPECT_FALSE(sure.mistake.found());
  EXPECT_FALSE(sure.ambiguous);
  EXPECT_EQ(sure.decisive, 1u);
}

TEST(DetectCommonConventions, FindsShiftVisibleInFewCases) {
  std::vector<VectorsWithTruth> files(5, written(uniform, same, {12.0, 0.0}));
  files.push_back(written(vortex, same, {12.0, 0.0}));
  CommonConventions const found = detect_common_conventions(files);
  expect_near(found.mistake.correction.shift_px, {-12.0, 0.0}, 0.01);  // a hundredth of a pixel is the last digit
  EXPECT_EQ(found.decisive, 5u);
}

// An offset of 0.5 px is 2.7 times the uniform displacement of 0.3 px in u; the vortex excludes that factor. Offset and
// factor are medians over vectors without noise, which differ from the true ones by a few roundings of 2e-16, whose
// number depends on the compiler. The tolerance allows for hundreds of them; a mistake of the other kind, with an
// offset of 0 or a factor of 1, misses by 0.1 or more.
TEST(DetectCommonConventions, TellsAnOffsetFromAFactor) {
  Flow const more = [](Vec2d d) { return d + Vec2d{0.5, 0.0}; };
  expect_near(detect_common_conventions({written(uniform, more), written(vortex, more)}).mistake.correction.offset_px,
              {0.5, 0.0}, 1e-13);
  Flow const longer = [](Vec2d d) { return 1.1 * d; };
  expect_near(detect_common_conventions({written(uniform, longer), written(vortex, longer)}).mistake.correction.factor,
              {1.1, 1.1}, 1e-13);
}

TEST(DetectCommonConventions, FindsNothingInCommonWhereEachFileHasItsOwnUnit) {
  std::vector<VectorsWithTruth> files;
  for (double const factor : {0.3, 2.0, 5.0})
    files.push_back(written(vortex, [factor](Vec2d d) { return factor * d; }));
  CommonConventions const found = detect_common_conventions(files);
  EXPECT_FALSE(found.mistake.found()) << describe_mistake(found.mistake);
  for (DetectedConventions const& one : found.detected) EXPECT_NE(one.mistake.correction.factor, (Vec2d{1.0, 1.0}));
}

// The format permits two offsets: half a pixel has an effect in the vortex, not in a uniform displacement.
TEST(DetectCommonConventions, ChoosesAmongTheFormatsOwnByAllFiles) {
  std::vector<VectorsWithTruth> files{written(uniform, same, {0.5, 0.5}), written(vortex, same, {0.5, 0.5})};
  for (VectorsWithTruth& one : files) {
    VectorConventions half;
    half.offset_px = -0.5;
    one.file.also = {half};
  }
  EXPECT_EQ(detect_common_conventions(files).conventions.offset_px, -0.5);
}

/// A fraction of outliers, and noise on all vectors.
VectorsWithTruth with_outliers(VectorsWithTruth written, double share, double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_px);
  std::uniform_real_distribution<double> wild(-5.0, 5.0), chance(0.0, 1.0);
  for (Vec2d& d : written.file.field.displacement_px) {
    Vec2d const error{noise(random), noise(random)}, anything{wild(random), wild(random)};
    d = chance(random) < share ? anything : d + error;
  }
  return written;
}

// Correct vectors with noise and outliers are not reported as a mistake, neither in a single case nor in several.
TEST(DetectCommonConventions, OutliersAreNoConventionError) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    for (double const share : {0.005, 0.01, 0.05}) {
      std::vector<VectorsWithTruth> files;
      for (Flow const& flow : {Flow(uniform), Flow(vortex), Flow(off_centre)}) {
        files.push_back(with_outliers(written(flow, same), share, 0.05, seed));
        CommonConventions const alone = detect_common_conventions({files.back()});
        EXPECT_FALSE(alone.mistake.found()) << describe_mistake(alone.mistake) << ' ' << seed << ' ' << share;
      }
      CommonConventions const all = detect_common_conventions(files);
      EXPECT_FALSE(all.mistake.found()) << describe_mistake(all.mistake) << ' ' << seed << ' ' << share;
    }
  }
}

TEST(DetectCommonConventions, FindsMistakesAmongOutliers) {
  struct Wrong {
    char const* conventions;  ///< conventions that correct it
    VectorCorrection correction;
    Flow change;
    Vec2d shift_px{};
  };
  // 34 outliers of 675 vectors, limited to three times the signal and without a preferred direction, change a mean by
  // 3 sqrt(34) / 675 = 2.6 % of the signal of 0.4 px, and a shift, with gradients of 0.03 px/px, by 0.35 px. The
  // tolerances are two such deviations.
  for (Wrong const& wrong : {
           Wrong{"y-down,v-down,frames-exchanged,offset=0", {}, [](Vec2d d) { return -d; }},
           Wrong{"y-down,v-down,components-exchanged,offset=0",
                 {},
                 [](Vec2d d) {
                   return Vec2d{d.y, d.x};
                 }},
           Wrong{"", {.shift_px = {-16.0, 0.0}}, same, {16.0, 0.0}},
           Wrong{"px/frame", {.factor = {10.0, 10.0}}, [](Vec2d d) { return 10.0 * d; }},
           Wrong{"px/frame", {.factor = {1.2, 1.2}}, [](Vec2d d) { return 1.2 * d; }},
           Wrong{"",
                 {.offset_px = {0.5, 0.0}},
                 [](Vec2d d) {
                   return d + Vec2d{0.5, 0.0};
                 }},
       }) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      std::vector<VectorsWithTruth> files;
      for (Flow const& flow : {Flow(uniform), Flow(vortex), Flow(off_centre)})
        files.push_back(with_outliers(written(flow, wrong.change, wrong.shift_px), 0.05, 0.03, seed));
      ProbableMistake const mistake = detect_common_conventions(files).mistake;
      EXPECT_THAT(mistake.conventions, testing::HasSubstr(wrong.conventions))
          << describe_mistake(mistake) << ' ' << seed;
      expect_near(mistake.correction.factor, wrong.correction.factor, 0.05 * wrong.correction.factor.x);
      expect_near(mistake.correction.shift_px, wrong.correction.shift_px, 0.7);
      expect_near(mistake.correction.offset_px, wrong.correction.offset_px, 0.021);
    }
  }
}

// Three files, one of them negated, one ten times too large, and one shifted: no common reading exists.
TEST(DetectCommonConventions, FindsNoCommonErrorAmongThree) {
  CommonConventions const found = detect_common_conventions({written(vortex, [](Vec2d d) { return -d; }),
                                                             written(uniform, [](Vec2d d) { return 10.0 * d; }),
                                                             written(off_centre, same, {16.0, 0.0})});
  EXPECT_FALSE(found.mistake.found()) << describe_mistake(found.mistake);
  for (DetectedConventions const& one : found.detected) EXPECT_TRUE(one.mistake.found());
  EXPECT_EQ(found.mistaken, (std::vector<std::size_t>{0, 1, 2}));
}

// One wrong file among correct ones is reported, whether it is ten times too large or noise.
TEST(DetectCommonConventions, ReportsSingleFaultyFile) {
  VectorsWithTruth const large = written(vortex, [](Vec2d d) { return 10.0 * d; }), right = written(off_centre, same);
  EXPECT_EQ(detect_common_conventions({right, written(uniform, same), large}).mistaken, std::vector<std::size_t>{2});
  VectorsWithTruth const noise = with_outliers(written(vortex, [](Vec2d) { return Vec2d{}; }), 0.0, 1.0, 1);
  EXPECT_EQ(detect_common_conventions({right, noise}).mistaken, std::vector<std::size_t>{1});
  EXPECT_TRUE(detect_common_conventions({right, written(uniform, same)}).mistaken.empty());
}

}  // namespace
}  // namespace gladstone
