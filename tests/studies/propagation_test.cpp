#include "studies/design/propagation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "studies/case/backend.h"
#include "studies/design/input_draws.h"
#include "studies/design/measurement_inputs.h"

namespace gladstone {
namespace {

/// Table 1: f = 105 mm, Z_A = 750 mm, Z_D = 250 mm, 10 um pixels; 0.0663 px are 10 kg/m^4 (physics: 0.006626657 px
/// each).
GradientMeasurement<double> measured_at_table1() {
  GradientMeasurement<double> at;
  at.value = {0.06626657, 10e-6, 0.105, 0.75, 0.25, 2.26e-4, 0.01, 1.225};
  at.window_px = 16;
  return at;
}

/// In px, um, mm, m^3/kg and kg/m^3, as written in setups.
MeasurementInput input(GradientInput enters, double value, double sigma,
                       InputDistribution distribution = InputDistribution::normal) {
  using I = GradientInput;
  MeasurementInput one;
  one.key = "input";
  one.unit = enters == I::pixel_pitch                                                                      ? 1e-6
             : enters == I::focal_length || enters == I::z_a || enters == I::z_d || enters == I::thickness ? 1e-3
                                                                                                           : 1;
  one.value = value;
  one.sigma = sigma;
  one.distribution = distribution;
  one.enters = enters;
  return one;
}

/// d ln(result) / d ln(input).
double log_derivative(PropagatedResult const& result, std::size_t i, MeasurementInput const& input) {
  return result.contributions[i].derivative * input.value / result.value;
}

// The gradient solves F6, so that the sensitivity of Table 1 gives 10 kg/m^4. With M = f / (Z_B - f) it is Delta p n0
// (Z_B - f) / (f Z_D K L_z): its derivatives are those of a product of powers, calculated by hand.
TEST(Propagation, HasTheDerivativesOfTheFormula) {
  GradientMeasurement<double> const at = measured_at_table1();
  EXPECT_NEAR(at.gradient(), 10, 1e-5);
  double const f = 0.105, z_a = 0.75, z_d = 0.25, rest = z_a + z_d - f, k_rho = 2.26e-4 * 1.225;
  std::vector<MeasurementInput> const inputs{input(GradientInput::displacement, at.value[0], 1e-3),
                                             input(GradientInput::pixel_pitch, 10, 1e-2),
                                             input(GradientInput::focal_length, 105, 1),
                                             input(GradientInput::z_a, 750, 1),
                                             input(GradientInput::z_d, 250, 1),
                                             input(GradientInput::gladstone_dale, 2.26e-4, 1e-6),
                                             input(GradientInput::thickness, 10, 0.1),
                                             input(GradientInput::ambient_density, 1.225, 0.01)};
  std::vector<double> const by_hand{
      1, 1, -f / rest - 1, z_a / rest, z_d / rest - 1, -1 + k_rho / (1 + k_rho), -1, k_rho / (1 + k_rho)};
  PropagatedResult const gradient = propagate(at, inputs)[0];
  double variance = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_NEAR(log_derivative(gradient, i, inputs[i]), by_hand[i], 1e-12) << i;
    double const part = by_hand[i] * inputs[i].sigma / inputs[i].value * gradient.value;
    EXPECT_NEAR(gradient.contributions[i].standard, std::abs(part), 1e-12 * gradient.value) << i;
    variance += part * part;
  }
  EXPECT_NEAR(gradient.standard, std::sqrt(variance), 1e-12);
}

// The density difference across a window has one more factor p and 1 / M_A = Z_A (Z_B - f) / (f Z_B): the pitch counts
// twice, and so does the focal length, -f / (Z_B - f) - 1.
TEST(Propagation, OfTheDensityCountsTheImagingTwice) {
  GradientMeasurement<double> const at = measured_at_table1();
  std::vector<MeasurementInput> const inputs{input(GradientInput::pixel_pitch, 10, 0.01),
                                             input(GradientInput::focal_length, 105, 1)};
  auto const results = propagate(at, inputs);
  EXPECT_NEAR(results[1].value, results[0].value * 16 * 10e-6 * 0.75 / (0.105 / 0.895), 1e-12);
  EXPECT_NEAR(log_derivative(results[1], 0, inputs[0]), 2, 1e-12);
  EXPECT_NEAR(log_derivative(results[1], 1, inputs[1]), 2 * (-0.105 / 0.895 - 1), 1e-12);
}

// Inputs with uncertainties of at most 0.5 %: the second order is (0.005)^2 of the uncertainty. The standard deviation
// of 10^5 samples has a standard error of 1 / sqrt(2 10^5) = 0.22 %; three of these are allowed.
TEST(Propagation, EqualsMonteCarloWhereItIsLinear) {
  GradientMeasurement<double> const at = measured_at_table1();
  auto const results =
      propagate(at, {input(GradientInput::displacement, at.value[0], 3e-4),
                     input(GradientInput::focal_length, 105, 0.3), input(GradientInput::z_d, 250, 1),
                     input(GradientInput::gladstone_dale, 2.26e-4, 1e-6, InputDistribution::rectangular)});
  for (PropagatedResult const& result : results) {
    EXPECT_NEAR(*result.sampled_standard / result.standard, 1, 0.0067) << result.key;
    EXPECT_NEAR(*result.sampled_mean, result.value, 3 * result.standard / std::sqrt(1e5) + 1e-4 * result.value);
    EXPECT_TRUE(result.linear);
    EXPECT_EQ(result.coverage_factor, 2);
  }
}

// 1 / L_z of a thickness with an uncertainty of 25 %: the mean of the gradient is 1 + 0.25^2 times as large in second
// order, and its distribution has a long tail.
TEST(Propagation, SaysWhereItIsNotLinear) {
  GradientMeasurement<double> const at = measured_at_table1();
  PropagatedResult const result = propagate(at, {input(GradientInput::thickness, 10, 2.5)})[0];
  EXPECT_FALSE(result.linear);
  EXPECT_GT(*result.sampled_mean, 1.05 * result.value);
  EXPECT_GT(result.sampled_high - result.value, 1.5 * (result.value - result.sampled_low));
}

// A rectangular distribution of half width sqrt(3) sigma has 95.45 % within 1.6532 sigma, not 2: its interval is
// shorter. With u = 0.9 the ends differ by 0.31, and half of the first digit is 0.05.
TEST(Propagation, SaysWhereARectangleIsNoNormalDistribution) {
  GradientMeasurement<double> const at = measured_at_table1();
  PropagatedResult const result = propagate(
      at, {input(GradientInput::displacement, at.value[0], 0.09 * at.value[0], InputDistribution::rectangular)})[0];
  EXPECT_NEAR(result.standard, 0.9, 1e-4);
  EXPECT_NEAR(*result.sampled_standard, 0.9, 0.9 * 0.0067);
  EXPECT_NEAR(result.sampled_high - result.value, std::sqrt(3.0) * 0.954499736 * 0.9, 0.005);
  EXPECT_FALSE(result.linear);
}

// JCGM 100:2008, table G.2, the column for 95.45 %.
TEST(Propagation, TakesTheCoverageFactorFromStudentsDistribution) {
  for (auto const& [degrees, factor] : {std::pair{1.0, 13.97},
                                        {2.0, 4.53},
                                        {3.0, 3.31},
                                        {5.0, 2.65},
                                        {10.0, 2.28},
                                        {20.0, 2.13},
                                        {50.0, 2.05},
                                        {HUGE_VAL, 2.0}}) {
    EXPECT_NEAR(coverage_factor(degrees), factor, 0.006) << degrees;
  }
}

// Welch and Satterthwaite: for two equal contributions with four degrees of freedom each, (2 u^2)^2 / (2 u^4 / 4) = 8.
TEST(Propagation, CombinesDegreesOfFreedom) {
  GradientMeasurement<double> const at = measured_at_table1();
  std::vector<MeasurementInput> inputs{input(GradientInput::displacement, at.value[0], 0.01 * at.value[0]),
                                       input(GradientInput::pixel_pitch, 10, 0.1)};
  for (MeasurementInput& one : inputs) one.degrees_of_freedom = 4;
  PropagatedResult const result = propagate(at, inputs)[0];
  EXPECT_NEAR(result.degrees_of_freedom, 8, 1e-9);
  EXPECT_NEAR(result.coverage_factor, 2.37, 0.005);
  EXPECT_NEAR(common_relative_uncertainty(at, inputs), 0.01, 1e-12);
}

/// Two distances with the given correlation.
std::vector<MeasurementInput> correlated_distances(double coefficient) {
  std::vector<MeasurementInput> inputs{input(GradientInput::displacement, measured_at_table1().value[0], 1e-9),
                                       input(GradientInput::z_a, 750, 2), input(GradientInput::z_d, 250, 1)};
  inputs[1].key = "z_a";
  inputs[2].key = "z_d";
  inputs[1].correlations = {{"z_d", coefficient}};
  inputs[2].correlations = {{"z_a", coefficient}};
  return inputs;
}

// JCGM 100:2008, eq. 16: the variance is the sum of c_i c_j u_i u_j r_ij, and that of the samples, too, within three
// standard errors (0.22 % each). With a coefficient of 1 the contributions add with their signs, with -1 they are
// subtracted: Z_A / (Z_B - f) of 2 / 750 and (Z_D / (Z_B - f) - 1) of 1 / 250.
TEST(Propagation, AddsTheCovariancesOfCorrelatedInputs) {
  GradientMeasurement<double> const at = measured_at_table1();
  double const rest = 1 - 0.105, a = 0.75 / rest * 2 / 750 * 10, d = (0.25 / rest - 1) / 250 * 10;
  for (double const r : {-1.0, -0.6, 0.0, 0.8, 1.0}) {
    PropagatedResult const result = propagate(at, correlated_distances(r))[0];
    double const expected = std::sqrt(a * a + d * d + 2 * r * a * d);
    EXPECT_NEAR(result.standard, expected, 1e-6) << r;
    EXPECT_NEAR(*result.sampled_standard / result.standard, 1, 0.0067) << r;
    EXPECT_NEAR(result.contributions[1].share + result.contributions[2].share, 1, 1e-6) << r;
    EXPECT_NEAR(result.contributions[1].standard, a, 1e-6) << r;
    EXPECT_NEAR(common_relative_uncertainty(at, correlated_distances(r)), expected / 10, 1e-7) << r;
  }
}

// Two identical inputs contain no more information than one: their contributions count as one with the smaller number
// of degrees of freedom, where Welch and Satterthwaite would count two.
TEST(Propagation, CountsCorrelatedInputsAsOneByDegreesOfFreedom) {
  std::vector<MeasurementInput> inputs = correlated_distances(1);
  inputs[1].degrees_of_freedom = 4;
  inputs[2].degrees_of_freedom = 9;
  EXPECT_NEAR(propagate(measured_at_table1(), inputs)[0].degrees_of_freedom, 4, 1e-5);
}

// For an evacuated ambient of 0 +- 0.02 kg/m^3 the index n0 = 1 + K rho has the derivative K, as for any density: g K,
// and the same fraction of the density across a window. Three standard errors of the standard deviation of the samples:
// 0.67 %.
TEST(Propagation, AcceptsZeroValues) {
  GradientMeasurement<double> at = measured_at_table1();
  at[GradientInput::ambient_density] = 0;
  for (PropagatedResult const& result : propagate(at, {input(GradientInput::ambient_density, 0, 0.02)})) {
    EXPECT_NEAR(result.contributions[0].derivative, 2.26e-4 * result.value, 1e-12) << result.key;
    EXPECT_NEAR(result.standard, 0.02 * 2.26e-4 * result.value, 1e-12) << result.key;
    EXPECT_NEAR(*result.sampled_standard / result.standard, 1, 0.0067) << result.key;
    EXPECT_TRUE(result.linear) << result.key;
  }
  EXPECT_NEAR(common_relative_uncertainty(at, {input(GradientInput::ambient_density, 0, 0.02)}), 0.02 * 2.26e-4, 1e-15);
}

// For zero displacement the uncertainty of the displacement contributes 1 / S = 150.9 kg/m^4 per pixel, and all other
// inputs nothing, since their effect is proportional to the displacement: in the samples by 0.5 % of a gradient whose
// mean is 0.
TEST(Propagation, HandlesZeroDisplacement) {
  GradientMeasurement<double> at = measured_at_table1();
  double const per_px = at.gradient() / at.value[0];
  at[GradientInput::displacement] = 0;
  std::vector<MeasurementInput> inputs{input(GradientInput::displacement, 0, 0.01), input(GradientInput::z_d, 250, 1),
                                       MeasurementInput{}};
  inputs[2].traced = 0.01;
  inputs[2].sigma = 1;
  PropagatedResult const result = propagate(at, inputs)[0];
  EXPECT_EQ(result.value, 0);
  EXPECT_NEAR(result.standard, 0.01 * per_px, 1e-12);
  EXPECT_NEAR(result.contributions[0].share, 1, 1e-12);
  EXPECT_EQ(result.contributions[1].standard, 0);
  EXPECT_EQ(result.contributions[2].standard, 0);
  EXPECT_NEAR(*result.sampled_standard / result.standard, 1, 0.0067);
  EXPECT_NEAR(common_relative_uncertainty(at, inputs), std::hypot((1 - 250.0 / 895) / 250, 0.01), 1e-12);
}

// JCGM 101:2008, 6.4.9: an input determined from nu + 1 readings is drawn from a t distribution, so that the interval
// with 95.45 % of the samples is that of Student's factor; the first order is valid for k u, and would be wrong by (k -
// 2) u for 2 u. The standard deviation is sqrt(nu / (nu - 2)) u. The standard error of a quantile with 2.3 % beyond it
// is sqrt(0.0228 0.9772 / 10^5) = 4.7e-4 over the density there: 0.017 u with ten degrees of freedom (density 0.027 /
// u), 0.023 u with four (0.0205), 0.29 u with one (0.0016). Four standard errors are allowed.
TEST(Propagation, DrawsFromStudentsDistributionWhatHasDegreesOfFreedom) {
  GradientMeasurement<double> const at = measured_at_table1();
  for (auto const& [degrees, factor, within] : {std::tuple{10.0, 2.284, 0.07}, {4.0, 2.869, 0.09}, {1.0, 13.97, 1.2}}) {
    MeasurementInput one = input(GradientInput::displacement, at.value[0], 0.02 * at.value[0]);
    one.degrees_of_freedom = degrees;
    PropagatedResult const result = propagate(at, {one})[0];
    EXPECT_NEAR((result.sampled_high - result.value) / result.standard, factor, within) << degrees;
    EXPECT_NEAR((result.value - result.sampled_low) / result.standard, factor, within) << degrees;
    EXPECT_TRUE(result.linear) << degrees;
    EXPECT_EQ(result.sampled_mean.has_value(), degrees > 1);
    EXPECT_EQ(result.sampled_standard.has_value(), degrees > 2);
    EXPECT_EQ(drawn_distribution({one}, 0), degrees == 1   ? "t, 1 degree of freedom"
                                            : degrees == 4 ? "t, 4 degrees of freedom"
                                                           : "t, 10 degrees of freedom");
    if (degrees < 10) continue;
    // the fourth moment for ten degrees of freedom is 4 sigma^4: a relative sqrt((4 - 1) / 4 / 10^5) = 0.27 %, three of
    // these
    EXPECT_NEAR(*result.sampled_standard / result.standard, std::sqrt(10.0 / 8), 0.0082 * std::sqrt(10.0 / 8));
  }
}

// Two correlated normal inputs with four degrees of freedom share one chi-squared variate: every sum of both has a t
// distribution with four degrees of freedom, as counted by Welch and Satterthwaite. With separate chi-squared variates
// the interval would end at 2.5 u.
TEST(Propagation, DrawsCorrelatedInputsWithOneChiSquared) {
  std::vector<MeasurementInput> inputs = correlated_distances(-0.8);
  for (std::size_t const i : {1u, 2u}) inputs[i].degrees_of_freedom = 4;
  PropagatedResult const result = propagate(measured_at_table1(), inputs)[0];
  EXPECT_NEAR((result.sampled_high - result.sampled_low) / (2 * result.standard), 2.869, 0.09);
  EXPECT_TRUE(result.linear);
  EXPECT_EQ(drawn_distribution(inputs, 0), "normal");
  inputs[1].degrees_of_freedom = 9;
  EXPECT_EQ(drawn_distribution(inputs, 1), "t, 4 degrees of freedom");
}

// A rectangular distribution whose half width has a relative uncertainty of 1 / sqrt(2 nu) has a variance 1 + 1 / (2
// nu) times as large (JCGM 101:2008, 6.4.3): 1.125 with four degrees of freedom. Its fourth moment is below the normal
// one, so that 0.67 % are three standard errors.
TEST(Propagation, DrawsRectanglesWithInexactLimits) {
  GradientMeasurement<double> const at = measured_at_table1();
  MeasurementInput one = input(GradientInput::displacement, at.value[0], 0.01, InputDistribution::rectangular);
  EXPECT_EQ(drawn_distribution({one}, 0), "rectangular");
  one.degrees_of_freedom = 4;
  EXPECT_EQ(drawn_distribution({one}, 0), "rectangular, limits inexact");
  PropagatedResult const result = propagate(at, {one})[0];
  EXPECT_NEAR(*result.sampled_standard / result.standard, std::sqrt(1.125), 0.0067 * std::sqrt(1.125));
}

// Chief rays through a uniform gradient, which no stop clips: the displacement per gradient is S, and the derivative of
// the gradient is its inverse. Off the axis it differs by theta^2 = (48 px p / z_i)^2 = 2e-5.
TEST(Propagation, HasTheSameDerivativesByTracingRays) {
  SetupDocument document = SetupDocument::from_text(R"(schema = 1
[camera]
pixels = [128, 128]
pixel_pitch_um = { value = 10.0, sigma = 0.01 }
[lens]
focal_length_mm = { value = 105.0, sigma = 0.5 }
[geometry]
z_a_mm = { value = 750.0, sigma = 1.0 }
z_d_mm = { value = 250.0, sigma = 1.0, distribution = "rectangular" }
[medium]
gladstone_dale = { value = 2.26e-4, sigma = 1e-6 }
thickness_mm = { value = 10.0, sigma = 0.1 }
[correlate]
window_px = [32]
)",
                                                    "table1");
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  ASSERT_EQ(uncertain.size(), 6u);
  Backend device = open_device("cpu");
  std::vector<MeasurementInput> const inputs = measurement_inputs(loaded, uncertain, *device.renderer);
  PropagatedResult const gradient = propagate(gradient_measurement(loaded.setup, 32, 0.1), inputs)[0];
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    ASSERT_TRUE(inputs[i].traced) << inputs[i].key;
    EXPECT_NEAR(-*inputs[i].traced * inputs[i].value, log_derivative(gradient, i, inputs[i]), 1e-3) << inputs[i].key;
  }
}

// A density of 0 permits no negative step: the difference is one-sided. The displacement of a dot is proportional to 1
// / n0, so that its logarithm has the derivative -K at the vacuum.
TEST(Propagation, TracesFromOneSideWhatCannotBeNegative) {
  SetupDocument document = SetupDocument::from_text(R"(schema = 1
[camera]
pixels = [64, 64]
[medium]
ambient_density_kg_m3 = { value = 0.0, sigma = 1.0 }
[correlate]
window_px = [32]
)",
                                                    "vacuum");
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  Backend device = open_device("cpu");
  std::optional<double> const slope = traced_log_derivative(loaded, uncertain.at(0), *device.renderer);
  ASSERT_TRUE(slope);
  EXPECT_NEAR(*slope, -2.26e-4, 1e-6);
}

// The formulas do not describe a double Gauss lens of 100 mm: differences of rays through it are used. On the axis it
// is the thin lens at its principal planes, so that both have the same derivatives, except for its aberrations and for
// dots off the axis: theta^2 = 2e-5 and less than 0.01 of a derivative.
TEST(Propagation, TracesWhatARealLensIsUncertainBy) {
  SetupDocument document = SetupDocument::from_text(R"(schema = 1
[camera]
pixels = [128, 128]
[lens]
model = "prescription"
file = "lenses/double_gauss.toml"
f_number = 8.0
[geometry]
z_a_mm = { value = 750.0, sigma = 1.0 }
z_d_mm = { value = 250.0, sigma = 1.0 }
[medium]
thickness_mm = { value = 10.0, sigma = 0.1 }
[correlate]
window_px = [32]
)",
                                                    "gauss", GLADSTONE_DATA_DIR);
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  Backend device = open_device("cpu");
  std::vector<MeasurementInput> const inputs = measurement_inputs(loaded, uncertain, *device.renderer);
  GradientMeasurement<double> const at = gradient_measurement(loaded.setup, 32, 0.1);
  auto const traced = propagate(at, inputs);
  ASSERT_EQ(inputs.size(), 3u);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    ASSERT_TRUE(inputs[i].traced) << inputs[i].key;
    EXPECT_FALSE(inputs[i].enters) << inputs[i].key;
    GradientInput const known = inputs[i].key == "geometry.z_a_mm"   ? GradientInput::z_a
                                : inputs[i].key == "geometry.z_d_mm" ? GradientInput::z_d
                                                                     : GradientInput::thickness;
    MeasurementInput const thin_input = input(known, inputs[i].value, 1);
    auto const thin = propagate(at, {thin_input});
    for (std::size_t k = 0; k < traced.size(); ++k) {  // gradient, and density across a window
      EXPECT_NEAR(log_derivative(traced[k], i, inputs[i]), log_derivative(thin[k], 0, thin_input), 0.01)
          << inputs[i].key << ", " << traced[k].key;
    }
  }
  for (PropagatedResult const& one : traced) EXPECT_NEAR(*one.sampled_standard / one.standard, 1, 0.0067) << one.key;
}

}  // namespace
}  // namespace gladstone
