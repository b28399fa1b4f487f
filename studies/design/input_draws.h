#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "render/base/random.h"
#include "studies/design/propagation.h"

namespace gladstone {

/// Inputs that are correlated with one another, directly or by others; one that is with none is a group by itself.
struct CorrelatedGroup {
  std::vector<Eigen::Index> members;
  double degrees_of_freedom = std::numeric_limits<double>::infinity();  ///< the fewest of theirs
};

/// Correlation coefficients of all pairs of inputs.
Eigen::MatrixXd coefficients_of(std::vector<MeasurementInput> const& inputs);

std::vector<CorrelatedGroup> correlated_groups(std::vector<MeasurementInput> const& inputs,
                                               Eigen::MatrixXd const& coefficients);

/// Draws all inputs less their values, one sample at a time, from what drawn_distribution() says.
class InputDraws {
 public:
  /// @pre the coefficients have a factor, as take_uncertain_inputs() sees to
  explicit InputDraws(std::vector<MeasurementInput> const& inputs);

  Eigen::VectorXd draw(KeyedEngine& engine) const;
  /// The fewest degrees of freedom of the t distributions that samples are drawn from; infinite: none.
  double fewest_degrees_of_t() const;

 private:
  MeasurementInput const& input(Eigen::Index i) const { return inputs_[static_cast<std::size_t>(i)]; }
  bool is_normal(Eigen::Index i) const { return input(i).distribution == InputDistribution::normal; }

  std::vector<MeasurementInput> const& inputs_;
  std::vector<CorrelatedGroup> groups_;
  Eigen::MatrixXd factor_;
};

}  // namespace gladstone
