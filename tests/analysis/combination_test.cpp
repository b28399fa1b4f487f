#include "analysis/uncertainty/combination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/uncertainty/uncertainty.h"

namespace gladstone {
namespace {

// Two methods estimate a and b, whose logarithms are independent and normal with a standard deviation of 0.5; the
// errors are normal with sigma = 0.6 a^0.8 b^0.3. Fisher's information on the logarithm of a standard deviation is 2
// per sample. From 40,000 samples a weight is therefore determined to 1/sqrt(2 40000 0.25) = 0.007 and the constant,
// far from the mean of ln a = ln b = -3, to about 0.03. Four standard deviations are allowed.
TEST(UncertaintyCombination, FindsTheWeightsThatMadeTheErrors) {
  std::mt19937_64 bits(3);
  std::normal_distribution<double> normal;
  std::vector<UncertaintySample> samples;
  for (int i = 0; i < 40000; ++i) {
    double const a = -3.0 + 0.5 * normal(bits), b = -3.0 + 0.5 * normal(bits);
    samples.push_back({{a, b}, 0.6 * std::exp(0.8 * a + 0.3 * b) * normal(bits)});
  }
  UncertaintyCombination const found = fit_combination(samples, {"one", "other"});
  ASSERT_EQ(found.terms.size(), 2u);
  EXPECT_EQ(found.terms[0].method, "one");
  EXPECT_NEAR(found.terms[0].weight, 0.8, 0.028);
  EXPECT_NEAR(found.terms[1].weight, 0.3, 0.028);
  EXPECT_NEAR(found.constant, std::log(0.6), 0.12);
  double const logarithms[] = {-3.0, -3.0};
  EXPECT_NEAR(found.log_sigma(logarithms), std::log(0.6) - 3.3, 0.02);
}

TEST(UncertaintyCombination, IsReadAsItIsWritten) {
  UncertaintyCombination const combination{-0.25, {{"one", 0.75}, {"other", 0.125}}};
  UncertaintyCombination const back = parse_combination(combination_text(combination));
  EXPECT_EQ(back.constant, -0.25);
  ASSERT_EQ(back.terms.size(), 2u);
  EXPECT_EQ(back.terms[1].method, "other");
  EXPECT_EQ(back.terms[1].weight, 0.125);
}

// A method without weight is ignored, whether it has a value or not. A method with a weight but without a value is
// omitted, and the other weights are scaled up: 1 + (2 3 + 1 9) (4/3) without the second term, whose weight is a
// quarter of the sum.
TEST(UncertaintyCombination, OmitsMethodsWithoutWeightOrValue) {
  UncertaintyCombination const combination{1.0, {{"one", 2.0}, {"other", 0.0}}};
  double const nan = std::nan(""), with[] = {3.0, nan}, without[] = {nan, 3.0};
  EXPECT_EQ(combination.log_sigma(with), 7.0);
  EXPECT_TRUE(std::isnan(combination.log_sigma(without)));
  UncertaintyCombination const three{1.0, {{"one", 2.0}, {"other", 1.0}, {"third", 1.0}}};
  double const two_known[] = {3.0, nan, 9.0};
  EXPECT_NEAR(three.log_sigma(two_known), 21.0, 1e-12);
}

TEST(ShippedCombination, IsOfMethodsThatThereAre) {
  std::vector<std::string> const methods = uncertainty_methods();
  EXPECT_FALSE(shipped_combination().terms.empty());
  for (auto const& [method, weight] : shipped_combination().terms) {
    EXPECT_NE(std::find(methods.begin(), methods.end(), method), methods.end()) << method;
    EXPECT_NE(method, "combination");
    EXPECT_TRUE(std::isfinite(weight));
  }
}

}  // namespace
}  // namespace gladstone
