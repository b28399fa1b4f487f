#include "analysis/errors/error_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "render/base/units.h"

namespace gladstone {
namespace {

/// A complete chain with correlated steps at n vectors.
std::vector<BudgetStage> chain(std::size_t n) {
  std::vector<BudgetStage> stages;
  double scale = 1.0;
  for (std::string_view const name : budget_stage_names()) {
    BudgetStage stage{std::string(name), std::vector<Vec2d>(n)};
    for (std::size_t i = 0; i < n; ++i) {
      double const x = 0.37 * static_cast<double>(i);
      stage.displacement_px[i] = {3.0 * scale * std::sin(x) + 0.01 * std::sin(7.0 * x * scale),
                                  -2.0 * scale * std::cos(1.7 * x) + 0.02 * scale * scale};
    }
    scale *= 0.93;
    stages.push_back(stage);
  }
  return stages;
}

BudgetTerm const& term(ErrorBudget const& budget, std::string_view name) {
  return *std::find_if(budget.terms.begin(), budget.terms.end(), [&](BudgetTerm const& t) { return t.name == name; });
}

// The sum over the chain telescopes: biases add up, and so do all entries of the covariance matrix (variance of a sum).
TEST(ErrorBudget, TermsAddUpToTheTotal) {
  std::vector<BudgetStage> const stages = chain(500);
  ErrorBudget const budget = error_budget(stages, VectorMask(500, 1));
  EXPECT_EQ(budget.count, 500u);
  EXPECT_LT(budget.closure_px, 1e-9);

  double bias_u = 0.0, bias_v = 0.0, covariance = 0.0;
  for (BudgetTerm const& t : budget.terms) {
    bias_u += t.bias_u_px;
    bias_v += t.bias_v_px;
    EXPECT_TRUE(t.includes.empty());
  }
  for (double const c : budget.covariance.values) covariance += c;
  EXPECT_NEAR(bias_u, budget.total.bias_u_px, 1e-9);
  EXPECT_NEAR(bias_v, budget.total.bias_v_px, 1e-9);
  double const u = budget.total.random_u_px, v = budget.total.random_v_px;
  EXPECT_NEAR(covariance, 0.5 * (u * u + v * v), 1e-12);

  // The total equals the error summary of the last stage against the first one.
  ErrorSummary const summary =
      summarize_errors(stages.back().displacement_px, stages.front().displacement_px, VectorMask(500, 1));
  EXPECT_DOUBLE_EQ(budget.total.rms_px, summary["rms_px"]);
}

TEST(ErrorBudget, CovarianceHoldsTheVariancesAndIsSymmetric) {
  ErrorBudget const budget = error_budget(chain(300), VectorMask(300, 1));
  ASSERT_EQ(budget.covariance.size, budget_term_names().size());
  for (std::size_t i = 0; i < budget.covariance.size; ++i) {
    BudgetTerm const& t = budget.terms[i];
    EXPECT_NEAR(budget.covariance_u(i, i), t.random_u_px * t.random_u_px, 1e-14);
    EXPECT_NEAR(budget.covariance_v(i, i), t.random_v_px * t.random_v_px, 1e-14);
    for (std::size_t j = 0; j < i; ++j) EXPECT_DOUBLE_EQ(budget.covariance(i, j), budget.covariance(j, i));
  }
}

TEST(ErrorBudget, NamesTheTermsOfTheContract) {
  std::vector<std::string_view> const names{"small_angle", "cone",      "refraction", "aberration",
                                            "window",      "estimator", "pattern",    "noise"};
  EXPECT_EQ(budget_term_names(), names);
}

// The chain of PIV: flow 1, without the medium 3, with it 2, window 2.5, noise-free 2.4, measured 2.6 px. The steps
// between them are the biases of the terms; eq9 is not a stage of this chain.
TEST(ErrorBudget, BeginsWithTheFlowOfPiv) {
  auto const all = [](double value) { return std::vector<Vec2d>(4, Vec2d{value, -value}); };
  std::vector<BudgetStage> const stages{{"measured", all(2.6)}, {"flow", all(1)}, {"ambient", all(3)},
                                        {"window", all(2.5)},   {"seen", all(2)}, {"noise_free", all(2.4)}};
  ErrorBudget const budget = error_budget(stages, VectorMask(4, 1), BudgetChain::piv);
  std::vector<std::string_view> const names{"projection", "refraction", "window", "estimator", "pattern", "noise"};
  EXPECT_EQ(budget_term_names(BudgetChain::piv), names);
  ASSERT_EQ(budget.terms.size(), names.size());
  for (auto const& [name, bias] :
       {std::pair{"projection", 2.0}, {"refraction", -1.0}, {"window", 0.5}, {"estimator", -0.1}, {"noise", 0.2}}) {
    EXPECT_NEAR(term(budget, name).bias_u_px, bias, 1e-15) << name;
    EXPECT_NEAR(term(budget, name).bias_v_px, -bias, 1e-15) << name;
  }
  EXPECT_NEAR(budget.total.bias_u_px, 1.6, 1e-15);
  EXPECT_LT(budget.closure_px, 1e-15);
}

// Vectors of another code: no noise-free images, no repeats. The remainder is attributed to the estimator; noise is
// unknown.
TEST(ErrorBudget, AttributesGapToFirstTerm) {
  std::vector<BudgetStage> stages = chain(50);
  std::erase_if(stages, [](BudgetStage const& s) { return s.name == "estimator"; });
  for (BudgetStage& s : stages) {
    if (s.name == "noise_free") s.displacement_px.clear();
  }
  ErrorBudget const budget = error_budget(stages, VectorMask(50, 1));
  EXPECT_EQ(term(budget, "estimator").includes, (std::vector<std::string>{"pattern", "noise"}));
  EXPECT_FALSE(term(budget, "pattern").known());
  EXPECT_FALSE(term(budget, "noise").known());
  EXPECT_TRUE(std::isnan(budget.covariance(7, 7)));
  EXPECT_LT(budget.closure_px, 1e-9);
  std::vector<Vec2d> const& window = stages[5].displacement_px;
  ASSERT_EQ(stages[5].name, "window");
  EXPECT_DOUBLE_EQ(term(budget, "estimator").rms_px,
                   summarize_errors(stages.back().displacement_px, window, {})["rms_px"]);
}

TEST(ErrorBudget, LeavesOutVectorsThatOneStageLacks) {
  std::vector<BudgetStage> stages = chain(10);
  stages[3].displacement_px[4].y = std::numeric_limits<double>::quiet_NaN();
  VectorMask mask(10, 1);
  mask[0] = 0;
  EXPECT_EQ(error_budget(stages, mask).count, 8u);
}

TEST(ErrorBudget, OfNoVectorsIsUnknown) {
  ErrorBudget const budget = error_budget(chain(3), VectorMask(3, 0));
  EXPECT_EQ(budget.count, 0u);
  EXPECT_FALSE(budget.total.known());
  EXPECT_TRUE(std::isnan(budget.peak_locking_px));
}

// error = A sin(2 pi f): the mean over a bin of width 1/20 is A sinc(1/20) times the value at its middle, so the rms
// over the bins is A/sqrt(2) sin(pi/20)/(pi/20). The displacement has steps of 1/4000, so sums over bins are midpoint
// sums with 200 points: relative error below 1e-5, which is 4e-7 px of 0.035 px.
TEST(PeakLocking, IsTheRmsOfTheBinnedSine) {
  std::vector<Vec2d> truth, error;
  for (int i = 0; i < 4000 * 3; ++i) {
    double const d = -1.5 + (i + 0.5) / 4000.0;
    truth.push_back({d, d + 10.0});
    error.push_back({0.05 * std::sin(2.0 * pi * d), 0.05 * std::sin(2.0 * pi * d)});
  }
  double const sinc = std::sin(pi / 20.0) / (pi / 20.0);
  EXPECT_NEAR(peak_locking(truth, error), 0.05 / std::sqrt(2.0) * sinc, 1e-6);
}

// A constant bias is not peak locking to fractions of a pixel, but appears as the mean of every bin.
TEST(PeakLocking, OfAConstantErrorIsThatError) {
  std::vector<Vec2d> truth, error;
  for (int i = 0; i < 100; ++i) {
    truth.push_back({0.013 * i, 0.0});
    error.push_back({-0.02, -0.02});
  }
  // The sum of a bin has at most ten terms: rounding errors of 1e-16 of 0.2 px each.
  EXPECT_NEAR(peak_locking(truth, error), 0.02, 1e-15);
}

}  // namespace
}  // namespace gladstone
