#include "studies/design/propagation.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/random_variates.h"
#include "studies/correlation_matrix.h"

namespace gladstone {
namespace {

using Jet = ceres::Jet<double, static_cast<int>(gradient_inputs)>;

/// Probability between -t and t.
double student_coverage(double t, double degrees) {
  // with t = sqrt(nu) tan(a): the integral of cos^(nu - 1), by Simpson's rule
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

GradientMeasurement<Jet> with_derivatives(GradientMeasurement<double> const& at) {
  GradientMeasurement<Jet> jets;
  jets.window_px = at.window_px;
  for (std::size_t i = 0; i < gradient_inputs; ++i) jets.value[i] = Jet(at.value[i], static_cast<int>(i));
  return jets;
}

/// d ln(result) / d(input): of what the formula has, by Jets; of the rest what tracing says, which is of the
/// displacement a gradient makes and so of the opposite sign.
/// @param from_gradient the result over the gradient
double log_derivative_of(MeasurementInput const& input, GradientMeasurement<double> const& at, Jet const& result,
                         Jet const& from_gradient) {
  if (!input.enters) {
    double derivative = input.traced ? -*input.traced : 0;
    if (input.scales) {
      auto const i = static_cast<std::size_t>(*input.scales);
      derivative += from_gradient.v[static_cast<Eigen::Index>(i)] * at.value[i] / (from_gradient.a * input.value);
    }
    return derivative;
  }
  auto const i = static_cast<std::size_t>(*input.enters);
  return input.chain * result.v[static_cast<Eigen::Index>(i)] * at.value[i] / (result.a * input.value);
}

Eigen::MatrixXd coefficients_of(std::vector<MeasurementInput> const& inputs) {
  auto const n = static_cast<Eigen::Index>(inputs.size());
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Identity(n, n);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (InputCorrelation const& one : inputs[i].correlations) {
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        if (inputs[k].key != one.with) continue;
        coefficients(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = one.coefficient;
      }
    }
  }
  return coefficients;
}

/// One draw of all inputs less their values. Those that are correlated are normal.
Eigen::VectorXd drawn(std::vector<MeasurementInput> const& inputs, Eigen::MatrixXd const& factor, KeyedEngine& engine) {
  Eigen::VectorXd off(static_cast<Eigen::Index>(inputs.size()));
  for (Eigen::Index i = 0; i < off.size(); ++i) {
    bool const normal = inputs[static_cast<std::size_t>(i)].distribution == InputDistribution::normal;
    off[i] = normal ? normal_variate(engine) : std::sqrt(3.0) * (2 * to_unit(engine()) - 1);
  }
  off = factor * off;
  for (Eigen::Index i = 0; i < off.size(); ++i) off[i] *= inputs[static_cast<std::size_t>(i)].sigma;
  return off;
}

/// The results of a sample: of what the formula has not, by what its logarithm changes.
std::array<double, 2> sample(GradientMeasurement<double> measurement, std::vector<MeasurementInput> const& inputs,
                             Eigen::VectorXd const& drawn) {
  double factor = 1;
  GradientMeasurement<double> whole = measurement;  // with what is not in the gradient's formula
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    MeasurementInput const& input = inputs[i];
    double const off = drawn[static_cast<Eigen::Index>(i)];
    if (!input.enters) {
      factor *= std::exp(input.traced ? -*input.traced * off : 0);
      if (input.scales) whole[*input.scales] *= 1 + off / input.value;
    } else {
      double const ratio = 1 + off / input.value;
      double const changed = input.chain == 1 ? ratio : std::pow(std::max(ratio, 1e-9), input.chain);
      measurement[*input.enters] *= changed;
      whole[*input.enters] *= changed;
    }
  }
  double const gradient = measurement.gradient() * factor;
  return {gradient, gradient * whole.density_over_gradient()};
}

double at_fraction(std::vector<double> const& sorted, double fraction) {
  double const place = fraction * static_cast<double>(sorted.size() - 1);
  auto const i = std::min(static_cast<std::size_t>(place), sorted.size() - 2);
  double const part = place - static_cast<double>(i);
  return (1 - part) * sorted[i] + part * sorted[i + 1];
}

constexpr double covered = 0.954499736;  ///< of a normal distribution within two standard deviations

void add_samples(PropagatedResult& result, std::vector<double> samples) {
  double sum = 0, squares = 0;
  for (double const one : samples) sum += one;
  result.sampled_mean = sum / static_cast<double>(samples.size());
  for (double const one : samples) squares += (one - result.sampled_mean) * (one - result.sampled_mean);
  result.sampled_standard = std::sqrt(squares / static_cast<double>(samples.size() - 1));
  std::sort(samples.begin(), samples.end());
  result.sampled_low = at_fraction(samples, (1 - covered) / 2);
  result.sampled_high = at_fraction(samples, (1 + covered) / 2);
  if (result.standard == 0) return;
  // JCGM 101, 7.9.2 with one significant digit: u = c 10^l, c from 1 to 9, delta = 10^l / 2
  double const delta = 0.5 * std::pow(10.0, std::floor(std::log10(result.standard)));
  double const reach = 2 * result.standard;
  result.linear = std::abs(result.value - reach - result.sampled_low) <= delta &&
                  std::abs(result.value + reach - result.sampled_high) <= delta;
}

/// Inputs that are correlated with one another, directly or by others; one that is with none is a group by itself.
struct CorrelatedGroup {
  std::vector<Eigen::Index> members;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< the fewest of theirs
};

std::vector<CorrelatedGroup> correlated_groups(std::vector<MeasurementInput> const& inputs,
                                               Eigen::MatrixXd const& coefficients) {
  std::vector<CorrelatedGroup> groups;
  std::vector<bool> entered(inputs.size());
  for (Eigen::Index first = 0; first < coefficients.rows(); ++first) {
    if (entered[static_cast<std::size_t>(first)]) continue;
    CorrelatedGroup& group = groups.emplace_back();
    std::vector<Eigen::Index> open{first};
    entered[static_cast<std::size_t>(first)] = true;
    while (!open.empty()) {
      Eigen::Index const i = open.back();
      open.pop_back();
      group.members.push_back(i);
      group.degrees_of_freedom =
          std::min(group.degrees_of_freedom, inputs[static_cast<std::size_t>(i)].degrees_of_freedom);
      for (Eigen::Index k = 0; k < coefficients.cols(); ++k) {
        if (coefficients(i, k) == 0 || entered[static_cast<std::size_t>(k)]) continue;
        entered[static_cast<std::size_t>(k)] = true;
        open.push_back(k);
      }
    }
  }
  return groups;
}

PropagatedResult first_order(std::string key, GradientMeasurement<double> const& at,
                             std::vector<MeasurementInput> const& inputs, Jet const& result, Jet const& from_gradient) {
  PropagatedResult out;
  out.key = std::move(key);
  out.value = result.a;
  Eigen::VectorXd parts(static_cast<Eigen::Index>(inputs.size()));  // c_i u(x_i), with their signs
  for (MeasurementInput const& input : inputs) {
    Contribution one;
    one.log_derivative = log_derivative_of(input, at, result, from_gradient);
    double const part = one.log_derivative * result.a * input.sigma;
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
  double low = 1.9, high = 20;  // nu = 1 has 13.97
  while (high - low > 1e-9) {
    double const middle = (low + high) / 2;
    (student_coverage(middle, degrees_of_freedom) < covered ? low : high) = middle;
  }
  return high;
}

std::vector<PropagatedResult> propagate(GradientMeasurement<double> const& at,
                                        std::vector<MeasurementInput> const& inputs) {
  GradientMeasurement<Jet> const jets = with_derivatives(at);
  std::vector<PropagatedResult> results{
      first_order("gradient_kg_m4", at, inputs, jets.gradient(), Jet(1.0)),
      first_order("density_step_kg_m3", at, inputs, jets.density_step(), jets.density_over_gradient())};
  std::optional<Eigen::MatrixXd> const factor = correlation_factor(coefficients_of(inputs));
  GLADSTONE_EXPECTS(factor);  // as take_uncertain_inputs() saw to
  std::array<std::vector<double>, 2> samples;
  for (int i = 0; i < propagation_samples; ++i) {
    KeyedEngine engine(1, RandomStream::sensor, static_cast<std::uint64_t>(i));
    std::array<double, 2> const one = sample(at, inputs, drawn(inputs, *factor, engine));
    for (std::size_t k = 0; k < results.size(); ++k) samples[k].push_back(one[k]);
  }
  for (std::size_t k = 0; k < results.size(); ++k) add_samples(results[k], std::move(samples[k]));
  return results;
}

double common_relative_uncertainty(std::vector<MeasurementInput> const& inputs, PropagatedResult const& gradient) {
  Eigen::VectorXd parts(static_cast<Eigen::Index>(inputs.size()));
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    bool const common = inputs[i].enters != GradientInput::displacement;
    parts[static_cast<Eigen::Index>(i)] = common ? gradient.contributions[i].log_derivative * inputs[i].sigma : 0;
  }
  return std::sqrt(std::max(0.0, parts.dot(coefficients_of(inputs) * parts)));
}

}  // namespace gladstone
