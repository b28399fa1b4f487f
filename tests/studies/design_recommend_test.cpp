#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/base/error.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/shared_folder.h"
#include "studies/design/branches.h"
#include "studies/design/recommend.h"
#include "tests/studies/support/requirement_bounds.h"
#include "tests/studies/support/table1_design.h"

namespace gladstone {
namespace {

using testing::Contains;
using testing::UnorderedElementsAre;

FreeChoice interval(Choice choice, double low, double high) { return {choice, {}, low, high}; }

/// The lens of Table 1 with both distances free.
DesignBranch free_distances(FixedDesignParameters const& given) {
  DesignBranch branch;
  branch.given = &given;
  branch.value = {0.105, 11, 0, 0, 0};
  branch.dot_px = 3;
  branch.continuous = {interval(Choice::z_a, 0.2, 5), interval(Choice::z_d, 0.05, 5)};
  return branch;
}

// If the view W = w Z_A (Z_B - f) / (f Z_B) is required, the sensitivity f Z_D / (Z_B - f) increases with Z_B, and with
// decreasing Z_A at the same Z_B: the best set-up has Z_B = Z, the longest allowed, and Z_A = W f Z / (w (Z - f)). The
// dot images have 3 px, so that the random error changes only with the PSF, through M.
TEST(Design, FindsTheOptimumOnPaper) {
  FixedDesignParameters const given = table1_given();
  constexpr double f = 0.105, z = 2.4, view = 0.08, sensor = 5.12e-3;
  std::vector<Limit> const required{{required::view_width, view}, {required::z_total, z}};
  Recommendation const answer = recommend(Objective::gradient_min, required, {free_distances(given)});
  ASSERT_TRUE(answer.feasible());
  BranchOutcome const& best = answer.outcomes.front();
  DesignPoint<double> const bench = design_point_at(best.branch, best.solution.logarithms);
  double const z_a = view * f * z / (sensor * (z - f));
  EXPECT_NEAR(bench.z_a, z_a, 1e-4 * z_a);
  EXPECT_NEAR(bench.z_d, z - z_a, 1e-4 * z);
  EXPECT_THAT(answer.binding, Contains("limits.z_total_max_mm"));
  EXPECT_THAT(answer.binding, Contains("requirements.field_of_view_mm[0]"));
  // S = f (Z - Z_A) / (Z - f), and a view 1 % wider requires 1 % more Z_A
  for (RequirementCost const& cost : answer.costs) {
    if (cost.bound == required::view_width) {
      EXPECT_NEAR(cost.change, (z - z_a) / (z - 1.01 * z_a) - 1, 1e-6);
    }
  }
}

// An interval with a single value is one binding constraint, not two.
TEST(Design, ReportsBindingValueOnce) {
  FixedDesignParameters const given = table1_given();
  DesignBranch branch = free_distances(given);
  branch.continuous = {interval(Choice::z_a, 0.75, 0.75), interval(Choice::z_d, 0.05, 0.25)};
  Recommendation const answer = recommend(Objective::gradient_min, {}, {branch});
  ASSERT_TRUE(answer.feasible());
  EXPECT_THAT(answer.binding, UnorderedElementsAre("limits.z_a_mm", "limits.z_d_mm[1]"));
}

// The random error as a function of the dot size: its derivative vanishes at the minimum, found by a golden-section
// search.
TEST(Design, FindsTheBestDotSize) {
  FixedDesignParameters given = table1_given();
  given.camera.noise.enabled = true;
  DesignBranch branch;
  branch.given = &given;
  branch.value = {0.105, 11, 0.75, 0.25, 0};
  branch.continuous = {interval(Choice::dot_diameter, 0.02e-3, 0.3e-3)};
  Recommendation const answer = recommend(Objective::uncertainty, {}, {branch});
  ASSERT_TRUE(answer.feasible());
  double best = HUGE_VAL;
  for (double d = 0.02e-3; d <= 0.3e-3; d *= 1.0001) {
    DesignPoint<double> const bench{&given, 0.105, 11, 0.75, 0.25, d};
    bool const within = bench.dot_image_px() <= random_error_range.most_image && bench.coverage() <= 0.45;
    if (within) best = std::min(best, bench.random_error());
  }
  EXPECT_NEAR(answer.outcomes.front().solution.objective, best, 1e-4 * best);
}

// A view of 300 mm at f = 105 mm and w = 5.12 mm requires a Z_A of 6 m, which exceeds the length of 2.4 m: the two
// requirements conflict.
TEST(Design, NamesTheFewestRequirementsThatConflict) {
  FixedDesignParameters const given = table1_given();
  std::vector<Limit> const required{{required::uncertainty_max, 1.0},
                                    {required::view_width, 0.3},
                                    {required::z_total, 2.4},
                                    {required::displacement_max, 100}};
  Recommendation const answer = recommend(Objective::resolution, required, {free_distances(given)});
  EXPECT_FALSE(answer.feasible());
  // the interval of Z_A ends at 5 m: the view alone is infeasible
  EXPECT_THAT(answer.conflicts, UnorderedElementsAre(required::view_width));
  ASSERT_EQ(answer.relaxations.size(), 1u);
  // within 2.4 m the widest view has the smallest Z_D, 50 mm
  double const widest = 5.12e-3 * 2.35 * (2.4 - 0.105) / (0.105 * 2.4);
  EXPECT_NEAR(answer.relaxations.front().value, widest, 2e-3 * widest);
}

TEST(Design, ReportsConflictingRequirements) {
  FixedDesignParameters const given = table1_given();
  std::vector<Limit> const required{
      {required::uncertainty_max, 1.0}, {required::view_width, 0.2}, {required::z_total, 2.4}};
  Recommendation const answer = recommend(Objective::resolution, required, {free_distances(given)});
  EXPECT_FALSE(answer.feasible());
  EXPECT_THAT(answer.conflicts, UnorderedElementsAre(required::view_width, required::z_total));
  EXPECT_EQ(answer.relaxations.size(), 2u);
}

// Pixels that are saturated at every distance exclude every set-up, whatever is required.
TEST(Design, ReportsLimitThatExcludesAllDesigns) {
  FixedDesignParameters given = table1_given();
  given.camera.exposure_e = 1000 * given.camera.noise.full_well_e;
  Recommendation const answer =
      recommend(Objective::resolution, {{required::uncertainty_max, 1.0}}, {free_distances(given)});
  EXPECT_FALSE(answer.feasible());
  EXPECT_TRUE(answer.conflicts.empty());
  ASSERT_TRUE(answer.without_requirements);
  EXPECT_EQ(answer.without_requirements->solution.worst, &below_full_well);
  EXPECT_GT(answer.without_requirements->solution.violation, std::log(10.0));
}

// Two requirements that are each infeasible: relaxing one does not help the other. Both are relaxed by the same factor,
// the larger one that either requires.
TEST(Design, RelaxesRequirementsJointly) {
  FixedDesignParameters const given = table1_given();
  std::vector<Limit> const required{
      {required::uncertainty_max, 1e-4}, {required::view_width, 0.3}, {required::z_total, 100}};
  Recommendation const answer = recommend(Objective::resolution, required, {free_distances(given)});
  EXPECT_FALSE(answer.feasible());
  EXPECT_TRUE(answer.relaxations.empty());
  ASSERT_EQ(answer.together.size(), 2u);
  EXPECT_EQ(answer.together[0].bound, required::uncertainty_max);
  EXPECT_EQ(answer.together[1].bound, required::view_width);
  double const factor = answer.together[0].value / 1e-4;
  EXPECT_GT(factor, 1);
  EXPECT_NEAR(0.3 / answer.together[1].value, factor, 1e-9);
  std::vector<Limit> lenient = required, short_of_it = required;
  for (int i = 0; i < 2; ++i) lenient[i].value = answer.together[i].value;
  EXPECT_TRUE(any_feasible({Objective::resolution, lenient}, {free_distances(given)}));
  for (int i = 0; i < 2; ++i) short_of_it[i].value = lenient[i].value * (i == 0 ? 0.99 : 1.01);
  EXPECT_FALSE(any_feasible({Objective::resolution, short_of_it}, {free_distances(given)}));
}

/// A question drawn from its seed: requirements about the performance of a medium set-up.
struct DrawnQuestion {
  Objective objective;
  std::vector<Limit> required;
  std::vector<DesignBranch> branches;
};

DrawnQuestion drawn_question(FixedDesignParameters const& given, unsigned seed) {
  std::mt19937 generator(seed);
  auto const uniform = [&generator](double low, double high) {
    return low + (high - low) * (static_cast<double>(generator()) / 4294967296.0);
  };
  DrawnQuestion question;
  question.objective = static_cast<Objective>(seed % 4);
  DesignPoint<double> middle{&given, 0.105, 11, uniform(0.5, 1.5), uniform(0.2, 1.0), 0};
  middle.dot_diameter = uniform(1.5, 3.5) * middle.pixel_at_dots();
  auto const loose = [&] { return std::exp(uniform(-0.4, 0.6)); };
  if (question.objective != Objective::gradient_min) {
    question.required.push_back({required::gradient_min, middle.smallest_gradient() * loose()});
  }
  if (question.objective != Objective::resolution) {
    question.required.push_back({required::resolution, resolved_wavelength(middle) * loose()});
  }
  question.required.push_back({required::view_width, 512 * middle.pixel_at_medium() / loose()});
  question.required.push_back({required::z_total, middle.z_b() * loose()});
  if (seed % 3 == 0)
    question.required.push_back({required::displacement_max, middle.largest_displacement_px() * loose()});
  for (double const f : {0.05, 0.085, 0.105, 0.2}) {
    for (double const stop : {5.6, 11.0, 22.0}) {
      DesignBranch branch;
      branch.given = &given;
      branch.value = {f, stop, 0, 0, 0};
      branch.continuous = {interval(Choice::z_a, 0.3, 2), interval(Choice::z_d, 0.1, 1.2),
                           interval(Choice::dot_diameter, 0.1e-3, 2e-3)};
      question.branches.push_back(branch);
    }
  }
  return question;
}

/// The best objective of a grid over every branch, about 10^5 set-ups in total; infinite: none is feasible.
double best_of_grid(DrawnQuestion const& question) {
  constexpr int distances = 24, sizes = 15;  // 12 branches of 24 x 24 x 15: 103,680
  double best = HUGE_VAL;
  for (DesignBranch const& branch : question.branches) {
    auto const at = [&branch](std::size_t i, int k, int count) {
      FreeChoice const& free = branch.continuous[i];
      return std::log(free.low) + std::log(free.high / free.low) * k / (count - 1);
    };
    std::vector<Limit> limits = feasibility_limits(*branch.given);
    limits.insert(limits.end(), question.required.begin(), question.required.end());
    // the most expensive last
    std::stable_partition(limits.begin(), limits.end(), [](Limit const& l) { return l.bound != required::resolution; });
    for (int point = 0; point < distances * distances * sizes; ++point) {
      DesignPoint<double> const bench = design_point_at(
          branch, std::vector<double>{at(0, point / sizes / distances, distances),
                                      at(1, point / sizes % distances, distances), at(2, point % sizes, sizes)});
      bool const kept =
          std::all_of(limits.begin(), limits.end(), [&bench](Limit const& limit) { return excess(limit, bench) <= 0; });
      if (kept) best = std::min(best, objective_value(question.objective, bench, bench));
    }
  }
  return best;
}

// The best point of a grid is no better than the global optimum, so a solver that finds the optimum is never worse than
// the grid; 2 % are allowed. If the solver finds no feasible point, neither may the grid.
TEST(Design, IsNeverWorseThanAGridOfAHundredThousandSetups) {
  FixedDesignParameters given = table1_given();
  given.camera.noise.enabled = true;
  given.largest_gradient = 20;
  int feasible = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    DrawnQuestion const question = drawn_question(given, seed);
    BranchSolution const found =
        solve_branches({question.objective, question.required}, question.branches).front().solution;
    double const grid = best_of_grid(question);
    if (!found.feasible()) {
      EXPECT_FALSE(std::isfinite(grid)) << seed << ": the grid found " << grid;
      continue;
    }
    ++feasible;
    EXPECT_LE(found.objective, 1.02 * grid) << seed;
  }
  EXPECT_GE(feasible, 8);
  EXPECT_LE(feasible, 19);
}

/// The shipped question with some keys replaced, and its branches.
struct ShippedQuestion {
  DesignQuestion question;
  std::vector<DesignVariant> variants;
  std::vector<SkippedVariant> skipped;
  std::vector<DesignBranch> branches;

  explicit ShippedQuestion(std::vector<std::string> const& overrides) {
    SetupDocument document = read_setup_document(shared_folder() + "/studies/cases/design.toml", overrides);
    SetupDocument const written = document.copy();
    question = *read_design_question(document);
    variants = design_variants(written, question, skipped);
    branches = design_branches(variants, question);
  }
  Recommendation recommended() const {
    return recommend(question.requirements.objective, question.requirements.limits, branches);
  }
};

// One lens and one stop, about 85 mm and f/22: f = 85 mm, Z_A = 1100 mm, Z_D = 640 mm and dots of 0.2 mm already
// satisfy 0.08 kg/m^4, and therefore every weaker requirement.
TEST(Design, FindsDesignThatMeetsStricterRequirement) {
  for (char const* const gradient : {"0.08", "0.09", "0.10", "0.11", "0.12", "0.13"}) {
    ShippedQuestion const asked({"requirements.objective=\"z_total\"",
                                 std::string("requirements.gradient_min_kg_m4=") + gradient,
                                 "inventory.focal_lengths_mm=[85]", "inventory.f_numbers=[22]"});
    EXPECT_TRUE(
        solve_branches({asked.question.requirements.objective, asked.question.requirements.limits}, asked.branches)
            .front()
            .solution.feasible())
        << gradient;
  }
}

// A set-up that satisfies the stricter requirement satisfies the weaker one, so that no cost is negative, and a front
// is monotone in its limit. At 0.1 kg/m^4 f = 50 mm, f/22, Z_A = 556.0 mm, Z_D = 649.1 mm, dots of 0.2432 mm are 1205.1
// mm long.
TEST(Design, NoStricterRequirementGains) {
  double longer = HUGE_VAL;
  for (char const* const gradient : {"0.08", "0.09", "0.1", "0.1001"}) {
    ShippedQuestion const asked(
        {"requirements.objective=\"z_total\"", std::string("requirements.gradient_min_kg_m4=") + gradient});
    Recommendation const answer = asked.recommended();
    ASSERT_TRUE(answer.feasible()) << gradient;
    double const length = answer.outcomes.front().solution.objective;
    EXPECT_LE(length, longer * (1 + 1e-6)) << gradient;
    longer = length;
    for (RequirementCost const& cost : answer.costs) EXPECT_GE(cost.change, -1e-4) << cost.bound->name;
    bool const more_is_stricter =
        answer.front_bound == required::view_width || answer.front_bound == required::view_height;
    for (std::size_t i = 1; i < answer.front.size(); ++i) {
      double const ratio = answer.front[i].objective / answer.front[i - 1].objective;
      EXPECT_LE(more_is_stricter ? 1 / ratio : ratio, 1 + 1e-6) << gradient << ' ' << answer.front[i].limit;
    }
  }
  EXPECT_LE(longer, 1.2051);
}

// A randomly drawn question for which a long random search found 0.10094 kg/m^4.
TEST(Design, FindsTheBestBehindALongSearch) {
  ShippedQuestion const asked({"requirements.resolution_mm=4.27776475182963", "requirements.displacement_max_px=1e6",
                               "requirements.field_of_view_mm=[87.64111349495506, 87.64111349495506]",
                               "requirements.uncertainty_max_px=0.006686455823232469",
                               "limits.z_total_max_mm=1506.2281774327887"});
  Recommendation const answer = asked.recommended();
  ASSERT_TRUE(answer.feasible());
  EXPECT_LE(answer.outcomes.front().solution.objective, 1.02 * 0.10094);
}

// Dots of 3 mm would cover the target more than once; the dot size is free, so this is not a reason for rejection.
TEST(DesignBranches, DotsThatAreChosenDoNotRefuseACamera) {
  ShippedQuestion const asked({"target.dot_diameter_mm=3"});
  EXPECT_EQ(asked.variants.size(), 1u);
  EXPECT_TRUE(asked.skipped.empty());
}

// Dots of 0.3 mm at M = 0.07 are 3.8 px of 5.5 um and 10.5 px of 2 um; 20 of the latter in 32 px would cover 1.7 times
// the target.
TEST(DesignBranches, SkipsACameraThatDoesNotGoWithTheSetup) {
  SetupDocument document =
      read_setup_document(shared_folder() + "/studies/cases/design.toml", {"target.dot_diameter_mm=0.3"});
  DesignQuestion question;
  question.free = {interval(Choice::z_a, 0.3, 2)};
  auto const camera = [](double pitch_um) {
    SetupNode table;
    table.members.push_back({"pixel_pitch_um", setup_number(pitch_um)});
    return table;
  };
  question.cameras = {{"/wide.toml", camera(5.5)}, {"/narrow.toml", camera(2)}};
  std::vector<SkippedVariant> skipped;
  std::vector<DesignVariant> const variants = design_variants(document, question, skipped);
  ASSERT_EQ(variants.size(), 1u);
  EXPECT_EQ(variants.front().camera, "/wide.toml");
  ASSERT_EQ(skipped.size(), 1u);
  EXPECT_EQ(skipped.front().name(), "narrow.toml");
  EXPECT_THAT(skipped.front().reason, testing::HasSubstr("target."));
  question.cameras = {{"/narrow.toml", camera(2)}};
  EXPECT_THROW(design_variants(document, question, skipped), SetupError);
}

}  // namespace
}  // namespace gladstone
