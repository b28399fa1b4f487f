#include "studies/design/propagation.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "render/base/random.h"
#include "studies/design/input_draws.h"

namespace gladstone::inline design {
namespace {

using InputJet = ceres::Jet<double, static_cast<int>(gradient_inputs)>;

/// Returns the probability of Student's t distribution between -t and t.
double student_coverage(double t, double degrees) {
  // Substituting t = sqrt(nu) tan(a) gives the integral of cos^(nu - 1); evaluated by Simpson's rule.
  constexpr int steps = 2000;
  double const end = std::atan(t / std::sqrt(degrees)), h = end / steps;
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    double const weight = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
    sum += weight * std::pow(std::cos(i * h), degrees - 1);
  }
  double const norm = std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(pi);
  return 2 * norm * sum * h / 3;
}

GradientMeasurement<InputJet> with_derivatives(GradientMeasurement<double> const& at) {
  GradientMeasurement<InputJet> jets;
  jets.window_px = at.window_px;
  for (std::size_t i = 0; i < gradient_inputs; ++i) jets.value[i] = InputJet(at.value[i], static_cast<int>(i));
  return jets;
}

/// Returns the derivative of the formula's input, in SI, with respect to the key in its unit.
double slope_of(MeasurementInput const& input, double value) {
  return input.chain == 1 ? input.unit : input.chain * value / input.value;
}

/// Returns d(result) / d(input): by Jets for inputs of the formula; for others from ray tracing, with the opposite
/// sign, since the displacement per gradient is what was differentiated by tracing.
/// @param from_gradient  the result divided by the gradient
double derivative_of(MeasurementInput const& input, GradientMeasurement<double> const& at, InputJet const& result,
                     InputJet const& from_gradient) {
  if (!input.enters) {
    double derivative = input.traced ? -*input.traced * result.a : 0;
    if (input.scales) {
      auto const i = static_cast<Eigen::Index>(*input.scales);
      derivative += from_gradient.v[i] * input.unit * result.a / from_gradient.a;
    }
    return derivative;
  }
  return result.v[static_cast<Eigen::Index>(*input.enters)] * slope_of(input, at[*input.enters]);
}

/// Computes the gradient and the density step of one sample. Inputs that the formula does not contain multiply the
/// gradient by the exponential of minus their traced logarithmic derivative times their deviation.
std::array<double, 2> sample(GradientMeasurement<double> measurement, std::vector<MeasurementInput> const& inputs,
                             Eigen::VectorXd const& drawn) {
  double factor = 1;
  // includes inputs that affect the density difference but not the gradient
  GradientMeasurement<double> whole = measurement;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    MeasurementInput const& input = inputs[i];
    double const off = drawn[static_cast<Eigen::Index>(i)];
    if (!input.enters) {
      factor *= std::exp(input.traced ? -*input.traced * off : 0);
      if (input.scales) whole[*input.scales] += input.unit * off;
    } else if (input.chain == 1) {
      measurement[*input.enters] += input.unit * off;
      whole[*input.enters] += input.unit * off;
    } else {
      double const changed = std::pow(std::max(1 + off / input.value, 1e-9), input.chain);
      measurement[*input.enters] *= changed;
      whole[*input.enters] *= changed;
    }
  }
  double const gradient = measurement.gradient() * factor;
  return {gradient, gradient * whole.density_over_gradient()};
}

double at_fraction(std::vector<double> const& sorted, double fraction) {
  double const place = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  auto const i = std::min(static_cast<std::size_t>(place), sorted.size() - 2);
  double const part = place - static_cast<double>(i);
  return (1 - part) * sorted[i] + part * sorted[i + 1];
}

/// Returns the standard error of at_fraction(): half the range between fractions shifted by one binomial standard
/// error.
double error_at_fraction(std::vector<double> const& sorted, double fraction) {
  double const one = std::sqrt(fraction * (1 - fraction) / static_cast<double>(sorted.size()));
  return (at_fraction(sorted, fraction + one) - at_fraction(sorted, fraction - one)) / 2;
}

constexpr double covered = 0.954499736;  ///< probability of a normal distribution within two standard deviations

/// Adds mean, standard deviation and coverage interval of the samples.
/// @param fewest  smallest number of degrees of freedom of the sampled t distributions
void add_samples(PropagatedResult& result, std::vector<double> samples, double fewest) {
  double sum = 0, squares = 0;
  for (double const one : samples) sum += one;
  double const mean = sum / static_cast<double>(samples.size());
  for (double const one : samples) squares += (one - mean) * (one - mean);
  if (fewest > 1) result.sampled_mean = mean;
  if (fewest > 2) result.sampled_standard = std::sqrt(squares / static_cast<double>(samples.size() - 1));
  std::sort(samples.begin(), samples.end());
  double const below = (1 - covered) / 2, above = (1 + covered) / 2;
  result.sampled_low = at_fraction(samples, below);
  result.sampled_high = at_fraction(samples, above);
  if (result.standard == 0) return;
  // JCGM 101:2008, 7.9.2 with one significant digit: u = c 10^l, c from 1 to 9, delta = 10^l / 2.
  double const delta = 0.5 * std::pow(10.0, std::floor(std::log10(result.standard)));
  result.linear =
      std::abs(result.value - result.expanded() - result.sampled_low) <=
          delta + 3 * error_at_fraction(samples, below) &&
      std::abs(result.value + result.expanded() - result.sampled_high) <= delta + 3 * error_at_fraction(samples, above);
}

PropagatedResult first_order(std::string key, GradientMeasurement<double> const& at,
                             std::vector<MeasurementInput> const& inputs, InputJet const& result,
                             InputJet const& from_gradient) {
  PropagatedResult out;
  out.key = std::move(key);
  out.value = result.a;
  Eigen::VectorXd parts(static_cast<Eigen::Index>(inputs.size()));  // c_i u(x_i), with sign
  for (MeasurementInput const& input : inputs) {
    Contribution one;
    one.derivative = derivative_of(input, at, result, from_gradient);
    double const part = one.derivative * input.sigma;
    one.standard = std::abs(part);
    parts[static_cast<Eigen::Index>(out.contributions.size())] = part;
    out.contributions.push_back(one);
  }
  Eigen::MatrixXd const coefficients = coefficients_of(inputs);
  Eigen::VectorXd const shares = parts.cwiseProduct(coefficients * parts);
  double const variance = std::max(0.0, shares.sum());
  out.standard = std::sqrt(variance);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    out.contributions[i].share = variance > 0 ? shares[static_cast<Eigen::Index>(i)] / variance : 0;
  }
  double over_degrees = 0;
  for (CorrelatedGroup const& group : correlated_groups(inputs, coefficients)) {
    double square = 0;
    for (Eigen::Index const i : group.members) square += shares[i];
    over_degrees += square * square / group.degrees_of_freedom;
  }
  out.degrees_of_freedom =
      over_degrees > 0 ? variance * variance / over_degrees : std::numeric_limits<double>::infinity();
  out.coverage_factor = coverage_factor(out.degrees_of_freedom);
  return out;
}

}  // namespace

double coverage_factor(double degrees_of_freedom) {
  if (!(degrees_of_freedom < 1e4)) return 2;
  double low = 1.9, high = 20;  // bounds of the factor: 2 for infinitely many degrees of freedom, 13.97 for one
  while (high - low > 1e-9) {
    double const middle = (low + high) / 2;
    (student_coverage(middle, degrees_of_freedom) < covered ? low : high) = middle;
  }
  return high;
}

std::vector<PropagatedResult> propagate(GradientMeasurement<double> const& at,
                                        std::vector<MeasurementInput> const& inputs) {
  GradientMeasurement<InputJet> const jets = with_derivatives(at);
  std::vector<PropagatedResult> results{
      first_order("gradient_kg_m4", at, inputs, jets.gradient(), InputJet(1.0)),
      first_order("density_step_kg_m3", at, inputs, jets.density_step(), jets.density_over_gradient())};
  InputDraws const draws(inputs);
  std::array<std::vector<double>, 2> samples;
  for (int i = 0; i < propagation_samples; ++i) {
    KeyedEngine engine(1, RandomStream::sensor, static_cast<std::uint64_t>(i));
    std::array<double, 2> const one = sample(at, inputs, draws.draw(engine));
    for (std::size_t k = 0; k < results.size(); ++k) samples[k].push_back(one[k]);
  }
  double const fewest = draws.fewest_degrees_of_t();
  for (std::size_t k = 0; k < results.size(); ++k) add_samples(results[k], std::move(samples[k]), fewest);
  return results;
}

double common_relative_uncertainty(GradientMeasurement<double> at, std::vector<MeasurementInput> const& inputs) {
  // arbitrary: the relative contribution of the other inputs does not depend on it
  at[GradientInput::displacement] = 1;
  InputJet const gradient = with_derivatives(at).gradient();
  Eigen::VectorXd parts(static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    bool const common = inputs[i].enters != GradientInput::displacement;
    parts[static_cast<Eigen::Index>(i)] =
        common ? derivative_of(inputs[i], at, gradient, InputJet(1.0)) / gradient.a * inputs[i].sigma : 0;
  }
  return std::sqrt(std::max(0.0, parts.dot(coefficients_of(inputs) * parts)));
}

}  // namespace gladstone::inline design
