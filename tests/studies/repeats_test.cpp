#include <cmath>
#include <limits>
#include <random>

#include "render/files/hdf5_file.h"
#include "render/files/text_file.h"
#include "studies/sweep/collect.h"
#include "studies/sweep/study_points.h"
#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Errors of vectors: a part common to all repeats, and an independent normal part for each repeat [px].
std::vector<std::vector<Vec2d>> made_up(std::size_t vectors, std::size_t repeats, double shared, double scatter) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec2d> common(vectors);
  for (Vec2d& c : common) c = {shared * normal(random), shared * normal(random)};
  std::vector<std::vector<Vec2d>> all(repeats, common);
  for (auto& one : all) {
    for (Vec2d& e : one) e += Vec2d{scatter * normal(random), scatter * normal(random)};
  }
  return all;
}

double mean_square(std::vector<std::vector<Vec2d>> const& all) {
  double sum = 0, count = 0;
  for (auto const& one : all) {
    for (Vec2d const& e : one) {
      sum += dot(e, e);
      count += 2;
    }
  }
  return sum / count;
}

// (1, 3) at one vector: mean 2, variance 2, so scatter^2 = 2 and systematic^2 = 4 - 2/2; the same in u and v.
TEST(RepeatSplit, IsMeanAndStandardDeviationOverRepeats) {
  std::vector<std::vector<Vec2d>> const two{{{1, -1}, {nan, nan}}, {{3, -3}, {5, 5}}};
  RepeatSplit const split = split_repeats(two);
  EXPECT_EQ(split.vectors, 1u);
  EXPECT_DOUBLE_EQ(split.scatter_px, std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(split.systematic_px, std::sqrt(3.0));
}

// Both parts are recovered from any number K of repeats, and their squares add up to the mean square. Tolerance: from n
// = 2 x 20000 components, the variance has a relative standard error of sqrt(2 / (n (K - 1))), at most 0.7 %, and the
// scatter therefore 0.35 %; the square of the systematic part has its own 0.7 % and the error of scatter^2 / K. The
// tolerances are five standard errors.
TEST(RepeatSplit, FindsWhatWasPutInWithAnyNumberOfRepeats) {
  for (std::size_t const repeats : {2, 3, 8}) {
    for (double const scatter : {0.005, 0.02, 0.05}) {
      auto const all = made_up(20000, repeats, 0.02, scatter);
      RepeatSplit const split = split_repeats(all);
      EXPECT_NEAR(split.scatter_px, scatter, 0.02 * scatter) << repeats;
      double const of_scatter = 5 * scatter * scatter / static_cast<double>(repeats) * 0.007;
      EXPECT_NEAR(split.systematic_px * split.systematic_px, 4e-4, 0.04 * 4e-4 + of_scatter) << repeats;
      EXPECT_NEAR(split.systematic_px * split.systematic_px + split.scatter_px * split.scatter_px, mean_square(all),
                  1e-12);
    }
  }
}

TEST(RepeatSplit, NeedsTwoRepeatsOfTheSameVectors) {
  std::vector<std::vector<Vec2d>> one{{{1, 1}}}, uneven{{{1, 1}}, {{1, 1}, {2, 2}}};
  EXPECT_TRUE(std::isnan(split_repeats(one).scatter_px));
  EXPECT_TRUE(std::isnan(split_repeats(uneven).systematic_px));
}

// Without scatter the systematic part is exact; without a common part the estimate of its square is zero on average,
// and negative values are set to 0.
TEST(RepeatSplit, OfOnePartAloneIsThatPart) {
  RepeatSplit const still = split_repeats(made_up(500, 4, 0.02, 0));
  EXPECT_NEAR(still.scatter_px, 0, 1e-15);
  RepeatSplit const noise = split_repeats(made_up(20000, 4, 0, 0.02));
  // scatter^2 / K is determined to sqrt(2 / (n (K - 1))) + sqrt(2 / n) = 1.2 %: 1.2e-6 px^2; five of these
  EXPECT_LT(noise.systematic_px, std::sqrt(5 * 1.2e-6));
}

class Repeats : public StudyFolder {
 protected:
  /// A study of two f-numbers and three repeats with artificial results: errors 0.01 (1 + point + 2 repeat) px, and
  /// every vector wrong by 0.03 px in all repeats plus -0.01, 0, 0.01 px.
  std::vector<ManifestCase> made_up_study() const {
    StudyPlan const plan = plan_study(study(R"(base = "base.toml"
[axes]
"lens.f_number" = [8, 16]
[study]
repeats = 3
)"),
                                      "cpu");
    write_plan(in("run"), plan);
    return all_cases(plan);
  }
  void write_made_up(ManifestCase const& one) const {
    CaseResult result;
    result.index = one.index;
    result.line_hash = one.line_hash;
    result.device = "cpu";
    double const point = static_cast<double>(one.index % 2), repeat = static_cast<double>(one.repeat);
    result.measures = {{"ray_truth.rms_px", 0.01 * (1 + point + 2 * repeat)}};
    double const off = 0.03 + 0.01 * (repeat - 1);
    for (std::string const& name : vector_error_names()) {
      result.vectors.push_back({name, {{off, -off}, {nan, nan}, {off, off}}});
    }
    write_result(in("run"), result);
  }
  static double at(StudyTable const& points, std::size_t row, std::string const& measure) {
    return points.rows.at(row).measures.at(points.find_measure(measure).value());
  }
};

TEST_F(Repeats, AreGatheredToATableOfPoints) {
  for (ManifestCase const& one : made_up_study()) write_made_up(one);
  StudyTable const points = study_points(collect_study(in("run")));
  ASSERT_EQ(points.rows.size(), 2u);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(at(points, p, "repeats"), 3);
    EXPECT_EQ(at(points, p, "vectors"), 2);
    // 0.01, 0.03, 0.05 (0.01 more at the second point): mean 0.03, standard deviation 0.02
    EXPECT_NEAR(at(points, p, "ray_truth.rms_px.mean"), 0.03 + 0.01 * static_cast<double>(p), 1e-15);
    EXPECT_NEAR(at(points, p, "ray_truth.rms_px.std"), 0.02, 1e-15);
    // standard deviation 0.01 px; mean square 9e-4 - 1e-4 / 3. Results hold vectors to 1e-6 px.
    for (std::string const name : {"ray_truth.scatter_px", "eq9.scatter_px", "budget.pattern_px"}) {
      EXPECT_NEAR(at(points, p, name), 0.01, 2e-6) << name;
    }
    for (std::string const name : {"ray_truth.systematic_px", "eq9.systematic_px", "budget.estimator_px"}) {
      EXPECT_NEAR(at(points, p, name), std::sqrt(9e-4 - 1e-4 / 3), 2e-6) << name;
    }
  }
  std::string const csv = read_text_file(in("run/study_points.csv"));
  EXPECT_TRUE(csv.starts_with("lens.f_number,case,repeats,vectors,ray_truth.systematic_px,ray_truth.scatter_px,"))
      << csv;
  EXPECT_THAT(csv, testing::HasSubstr("\n16,1,3,2,"));
  Hdf5Reader const file(in("run/study.h5"));
  EXPECT_EQ(file.read("/points/lens.f_number"), (std::vector<double>{8, 16}));
  EXPECT_NEAR(file.read("/points/ray_truth.rms_px.mean").at(1), 0.04, 1e-15);
  EXPECT_EQ(file.read("/ray_truth.rms_px").size(), 6u);
}

TEST_F(Repeats, ThatAreMissingLeaveThePointsToTheOthers) {
  auto const cases = made_up_study();
  for (std::size_t const i : {0, 1, 2}) write_made_up(cases[i]);  // point 0 twice, point 1 once
  StudyTable const points = study_points(collect_study(in("run")));
  EXPECT_EQ(at(points, 0, "repeats"), 2);
  EXPECT_NEAR(at(points, 0, "ray_truth.scatter_px"), std::sqrt(0.5) * 0.01, 2e-6);
  EXPECT_EQ(at(points, 1, "repeats"), 1);
  EXPECT_NEAR(at(points, 1, "ray_truth.rms_px.mean"), 0.02, 1e-15);
  EXPECT_TRUE(std::isnan(at(points, 1, "ray_truth.rms_px.std")));
  EXPECT_TRUE(std::isnan(at(points, 1, "ray_truth.scatter_px")));
}

}  // namespace
}  // namespace gladstone
