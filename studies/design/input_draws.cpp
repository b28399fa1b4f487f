#include "studies/design/input_draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/random_variates.h"
#include "studies/case/correlation_matrix.h"

namespace gladstone::inline design {
namespace {

/// Draws chi squared over its degrees of freedom, which may be any real number: twice a gamma variate with half of them
/// as shape (Marsaglia & Tsang, ACM Transactions on Mathematical Software 26 (2000) 363; for a shape below one, their
/// section 6).
double mean_square_variate(KeyedEngine& engine, double degrees) {
  double const shape = degrees / 2;
  double boost = 1;
  if (shape < 1) boost = std::pow(1 - to_unit(engine()), 1 / shape);
  double const d = (shape < 1 ? shape + 1 : shape) - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    double const x = normal_variate(engine), root = 1 + c * x;
    if (root <= 0) continue;
    double const v = root * root * root;
    if (std::log(1 - to_unit(engine())) < 0.5 * x * x + d - d * v + d * std::log(v)) return boost * d * v / shape;
  }
}

/// Returns the relative range by which the half width of a rectangular distribution varies either way: that of a
/// uniform variate with standard deviation 1 / sqrt(2 nu), limited to 1 so that the width is not negative.
double limits_reach(double degrees) { return std::min(1.0, std::sqrt(1.5 / degrees)); }

}  // namespace

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

InputDraws::InputDraws(std::vector<MeasurementInput> const& inputs) : inputs_(inputs) {
  Eigen::MatrixXd const coefficients = coefficients_of(inputs);
  groups_ = correlated_groups(inputs, coefficients);
  std::optional<Eigen::MatrixXd> const factor = correlation_factor(coefficients);
  GLADSTONE_EXPECTS(factor);
  factor_ = *factor;
}

Eigen::VectorXd InputDraws::draw(KeyedEngine& engine) const {
  Eigen::VectorXd off(static_cast<Eigen::Index>(inputs_.size()));
  for (Eigen::Index i = 0; i < off.size(); ++i) {
    off[i] = is_normal(i) ? normal_variate(engine) : std::sqrt(3.0) * (2 * to_unit(engine()) - 1);
  }
  off = factor_ * off;
  for (CorrelatedGroup const& group : groups_) {
    if (!std::isfinite(group.degrees_of_freedom)) continue;
    double const wider = is_normal(group.members.front())
                             ? 1 / std::sqrt(mean_square_variate(engine, group.degrees_of_freedom))
                             : 1 + limits_reach(group.degrees_of_freedom) * (2 * to_unit(engine()) - 1);
    for (Eigen::Index const i : group.members) off[i] *= wider;
  }
  for (Eigen::Index i = 0; i < off.size(); ++i) off[i] *= input(i).sigma;
  return off;
}

double InputDraws::fewest_degrees_of_t() const {
  double fewest = std::numeric_limits<double>::infinity();
  for (CorrelatedGroup const& group : groups_) {
    for (Eigen::Index const i : group.members) {
      if (is_normal(i) && input(i).sigma > 0) fewest = std::min(fewest, group.degrees_of_freedom);
    }
  }
  return fewest;
}

std::string drawn_distribution(std::vector<MeasurementInput> const& inputs, std::size_t input) {
  auto const i = static_cast<Eigen::Index>(input);
  bool const normal = inputs[input].distribution == InputDistribution::normal;
  for (CorrelatedGroup const& group : correlated_groups(inputs, coefficients_of(inputs))) {
    if (std::find(group.members.begin(), group.members.end(), i) == group.members.end()) continue;
    double const degrees = group.degrees_of_freedom;
    if (!std::isfinite(degrees)) break;
    if (!normal) return "rectangular, limits inexact";
    return fmt::format("t, {:.3g} degree{} of freedom", degrees, degrees == 1 ? "" : "s");
  }
  return to_string(inputs[input].distribution);
}

}  // namespace gladstone::inline design
