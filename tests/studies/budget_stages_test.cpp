#include "studies/compare/budget_stages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/compare/comparison_results.h"
#include "studies/report/case_view.h"

namespace gladstone {
namespace {

/// Stages of four vectors, with a different increment for each stage; the third vector is excluded.
Comparison comparison_of(BudgetChain chain, bool noise_free) {
  double level = 0;
  auto const next = [&level] {
    std::vector<Vec2d> stage;
    level += 1;
    for (int i = 0; i < 4; ++i) stage.push_back({level * level + 0.1 * i, std::sin(level * (i + 1))});
    return stage;
  };
  Comparison comparison;
  comparison.chain = chain;
  comparison.mask = {1, 1, 0, 1};
  if (chain == BudgetChain::piv) {
    comparison.flow_px = next();
    comparison.ambient_px = next();
  } else {
    comparison.point.eq9_px = next();
    comparison.point.chief_px = next();
    comparison.point.eq9_cone_px = next();
    comparison.thin_lens = next();
  }
  comparison.point.displacement_px = next();
  comparison.window.displacement_px = next();
  if (noise_free) comparison.noise_free = next();
  comparison.measured.displacement_px = next();
  comparison.budget = error_budget(budget_stages(comparison, comparison.window), comparison.mask, chain);
  return comparison;
}

// The map of a cause agrees with the budget: the same names in the same order, the same rms, and their sum is the
// difference between the first stage and the measurement.
TEST(BudgetDifferences, AreTheBudgetsTerms) {
  for (BudgetChain const chain : {BudgetChain::bos, BudgetChain::piv}) {
    for (bool const noise_free : {true, false}) {
      Comparison const comparison = comparison_of(chain, noise_free);
      std::vector<BudgetStage> const causes = budget_differences(comparison);
      std::vector<Vec2d> sum(4);
      std::size_t next = 0;
      for (BudgetTerm const& term : comparison.budget.terms) {
        if (!term.known()) continue;
        ASSERT_LT(next, causes.size());
        BudgetStage const& cause = causes[next++];
        EXPECT_EQ(cause.name, term.name);
        double square = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          sum[i] += cause.displacement_px[i];
          if (comparison.mask[i]) square += dot(cause.displacement_px[i], cause.displacement_px[i]) / 6;
        }
        EXPECT_NEAR(std::sqrt(square), term.rms_px, 1e-12) << term.name;
      }
      EXPECT_EQ(next, causes.size());
      std::vector<Vec2d> const& first = chain == BudgetChain::piv ? comparison.flow_px : comparison.point.eq9_px;
      for (std::size_t i = 0; i < 4; ++i) {
        if (comparison.mask[i]) {
          EXPECT_NEAR(length(sum[i] - (comparison.measured.displacement_px[i] - first[i])), 0, 1e-12);
        } else {
          EXPECT_TRUE(std::isnan(sum[i].x)) << "the vector is not compared";
        }
      }
    }
  }
}

/// Returns the term of a budget by name.
BudgetTerm const& term_of(ErrorBudget const& budget, std::string const& name) {
  for (BudgetTerm const& term : budget.terms) {
    if (term.name == name) return term;
  }
  ADD_FAILURE() << name;
  return budget.total;
}

// An undeformed window would lose 0.46 px of u, of which the passes recover 0.44 px, so that `window` and `estimator`
// cancel to 0.02 px: the largest cause is the cone, 0.04 px. The loss after the passes is 0.02 px; maps and errors.json
// have the same value.
TEST(ShownBudget, CountsAWindowAfterItsPasses) {
  Comparison comparison;
  comparison.mask.assign(3, 1);
  auto const level = [](double u) { return std::vector<Vec2d>(3, {u, 0}); };
  comparison.point.eq9_px = comparison.point.chief_px = level(1);
  comparison.point.eq9_cone_px = comparison.thin_lens = comparison.point.displacement_px = level(0.96);
  comparison.window.displacement_px = level(0.50);
  comparison.deformed_window.displacement_px = level(0.94);
  comparison.frames_deformed = true;
  comparison.noise_free = comparison.measured.displacement_px = level(0.94);
  comparison.budget = error_budget(budget_stages(comparison, comparison.window), comparison.mask);
  comparison.budget_after_passes = error_budget(budget_stages(comparison, comparison.deformed_window), comparison.mask);
  EXPECT_NEAR(term_of(comparison.budget, "window").bias_u_px, -0.46, 1e-12);
  EXPECT_NEAR(term_of(comparison.shown_budget(), "window").bias_u_px, -0.02, 1e-12);
  EXPECT_NEAR(term_of(comparison.shown_budget(), "estimator").bias_u_px, 0, 1e-12);
  EXPECT_NEAR(comparison.shown_budget().total.bias_u_px, comparison.budget.total.bias_u_px, 1e-15);
  EXPECT_LT(comparison.shown_budget().closure_px, 1e-9);
  std::string const headline = largest_term(comparison.shown_budget());
  EXPECT_THAT(headline, testing::HasSubstr("cone"));
  for (BudgetStage const& cause : budget_differences(comparison)) {
    EXPECT_NEAR(cause.displacement_px[0].x, term_of(comparison.shown_budget(), cause.name).bias_u_px, 1e-12)
        << cause.name;
  }
  nlohmann::ordered_json const budget = compute_error_measures(comparison)["budget"];
  EXPECT_NEAR(budget["terms"]["window"]["bias_u_px"].get<double>(), -0.46, 1e-12) << "as ever";
  EXPECT_NEAR(budget["after_passes"]["terms"]["window"]["bias_u_px"].get<double>(), -0.02, 1e-12);
  EXPECT_NEAR(budget["after_passes"]["terms"]["estimator"]["rms_px"].get<double>(), 0, 1e-12);
  EXPECT_THAT(error_report(comparison), testing::HasSubstr("for an undeformed window"));
}

}  // namespace
}  // namespace gladstone
