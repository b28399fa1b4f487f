#include "studies/budget_stages.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gladstone {
namespace {

/// Stages of four vectors, each beyond the one before it by other amounts; the third vector does not count.
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
  comparison.budget = error_budget(budget_stages(comparison), comparison.mask, chain);
  return comparison;
}

// What a map shows of a cause is what the budget says of it: the same names in the same order, the same rms, and all of
// them together the way from the first stage to the measurement.
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
          EXPECT_TRUE(std::isnan(sum[i].x)) << "does not count";
        }
      }
    }
  }
}

}  // namespace
}  // namespace gladstone
