#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "analysis/tomography/line_projector.h"
#include "analysis/tomography/line_samples.h"
#include "render/base/host_device.h"
#include "render/base/regular_grid.h"

namespace gladstone::inline tomography {

/// Lines of one view with the sums of their weights, and the line integrals that the iteration uses.
struct SartView {
  LineProjector projector;
  std::vector<double> value;  ///< line integrals [kg/m^2, lines]; NaN: the line is ignored
};

/// Bounds and support of a volume, passed by value.
struct NodeConstraint {
  double lowest, highest;                 ///< bounds of the density difference [kg/m^3]
  std::uint8_t const* support = nullptr;  ///< 1: the value may differ from zero [nodes]; null: everywhere

  GLADSTONE_HD bool is_free(std::size_t node) const { return support == nullptr || support[node] != 0; }
  GLADSTONE_HD double operator()(double value, std::size_t node) const {
    if (!is_free(node)) return 0.0;
    return value < lowest ? lowest : (value > highest ? highest : value);
  }
};

/// Residual of a line integral, and the residual divided by the line's sum of weights; SART projects this quotient
/// back.
struct LineResidual {
  double difference, quotient;  ///< residual [kg/m^2] and quotient [kg/m^3]; NaN: the line is ignored
  GLADSTONE_HD static LineResidual of(double value, double projected, double row_sum) {
    return {value - projected, (value - projected) / row_sum};
  }
};

/// Returns the value of a node after the correction by one view. @pre the sum of the weights is positive
GLADSTONE_HD inline double correct_node(double value, NodeSum const& sum, double relaxation) {
  return value + relaxation * sum.value / sum.weight;
}

/// Sums over a sweep, before regularisation.
struct SweepSums {
  /// Sum of the squared residuals of the line integrals of each view, before the correction by this view [kg^2/m^4,
  /// views].
  std::vector<double> residual;
  std::vector<double> value;  ///< sum of the squares of the line integrals of each view [kg^2/m^4, views]
  double change = 0.0;        ///< sum over the nodes of the support of the squared change by the views [kg^2/m^6]
  double largest = 0.0;       ///< largest absolute value of a node [kg/m^3]
};

/// Squared norms after regularisation [kg^2/m^6].
struct SweepNorms {
  double change = 0.0;  ///< squared norm of the difference from the volume before the sweep
  double volume = 0.0;  ///< squared norm of the volume
};

/// Volume in the memory of one device, with the steps of SART. The class makes no decisions: reconstruct_volume()
/// determines the order of the views, the weights and the end of the iteration. Results do not depend on the order of
/// execution.
class SartVolume {
 public:
  virtual ~SartVolume() = default;
  virtual std::string device() const = 0;
  /// Corrects the volume by one view. If `count_views` is true, as in the first sweep, also counts the views that see
  /// each node.
  virtual void correct(std::size_t view, bool count_views) = 0;
  /// Returns the sums since the last regularize().
  virtual SweepSums sum_sweep() = 0;
  /// Applies total variation of the given strength [kg/m^3], bounds and support.
  virtual SweepNorms regularize(double lambda, int tv_iterations) = 0;
  /// Copies the density difference [kg/m^3] to `value`, and the number of views of each node to `views`.
  virtual void download(std::vector<double>& value, std::vector<std::int64_t>& views) const = 0;
};

/// Inputs of a SartVolume. Views, support and the lines of the views must outlive it.
struct SartProblem {
  RegularGrid grid;
  std::span<SartView const> views;
  double relaxation;
  double lowest, highest;                 ///< bounds [kg/m^3]
  std::span<std::uint8_t const> support;  ///< nodes whose value may differ from zero, see SartSettings
};

/// Creates a volume of zeros on a device.
using SartVolumeMaker = std::function<std::unique_ptr<SartVolume>(SartProblem const&)>;

/// Creates a volume on the CPU. Its results do not depend on the number of threads.
std::unique_ptr<SartVolume> make_host_volume(SartProblem const& problem);

}  // namespace gladstone::inline tomography
