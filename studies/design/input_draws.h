#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "render/base/random.h"
#include "studies/design/propagation.h"

namespace gladstone::inline design {

/// Group of inputs correlated directly or through other inputs; an uncorrelated input forms a group of one.
struct CorrelatedGroup {
  std::vector<Eigen::Index> members;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< smallest degrees of freedom of the members
};

/// Returns the matrix of correlation coefficients of all inputs.
Eigen::MatrixXd coefficients_of(std::vector<MeasurementInput> const& inputs);

/// Partitions the inputs into groups that are mutually uncorrelated.
std::vector<CorrelatedGroup> correlated_groups(std::vector<MeasurementInput> const& inputs,
                                               Eigen::MatrixXd const& coefficients);

/// Draws samples of all inputs minus their values, from the distributions named by drawn_distribution().
class InputDraws {
 public:
  /// @pre the coefficients have a Cholesky factor, as checked by extract_uncertain_inputs()
  explicit InputDraws(std::vector<MeasurementInput> const& inputs);

  /// Draws one sample, with one component per input in its own unit.
  Eigen::VectorXd draw(KeyedEngine& engine) const;
  /// Returns the smallest number of degrees of freedom of the t distributions in use; infinity if none is.
  double fewest_degrees_of_t() const;

 private:
  MeasurementInput const& input(Eigen::Index i) const { return inputs_[static_cast<std::size_t>(i)]; }
  bool is_normal(Eigen::Index i) const { return input(i).distribution == InputDistribution::normal; }

  std::vector<MeasurementInput> const& inputs_;
  std::vector<CorrelatedGroup> groups_;
  Eigen::MatrixXd factor_;
};

/// Returns the distribution from which samples of an input are drawn: "normal"; "t, 4 degrees of freedom", scaled by
/// sigma and shifted to the value (JCGM 101:2008, 6.4.9), with a common chi-squared variate for correlated inputs;
/// "rectangular"; or "rectangular, limits inexact", a curvilinear trapezoid (6.4.3) whose half width has a relative
/// uncertainty of 1 / sqrt(2 nu), as has sigma (JCGM 100:2008, G.4.2).
std::string drawn_distribution(std::vector<MeasurementInput> const& inputs, std::size_t input);

}  // namespace gladstone::inline design
