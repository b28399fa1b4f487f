#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "analysis/correlator.h"
#include "analysis/vector_validation.h"
#include "analysis/window_measurement.h"
#include "analysis/window_ops.h"
#include "render/base/host_device.h"

namespace gladstone {

/// Standard cross-correlation in passes: every pass deforms both images by what the one before found (validated,
/// smoothed), correlates smaller windows, and adds what is left. The first pass looks for shifts up to half a window,
/// the later ones up to a quarter. Only predictors are smoothed, never the result.
std::unique_ptr<Correlator> make_standard_correlator(CorrelationSettings const& settings);

/// What a CPU or CUDA correlator does in which order.
class CorrelationSchedule {
 public:
  /// @pre at least one window and one final pass
  explicit CorrelationSchedule(CorrelationSettings const& settings);

  int passes() const { return static_cast<int>(windows_.size()); }
  bool is_last(int pass) const { return pass + 1 == passes(); }
  InterrogationGrid grid(int pass, int columns, int rows) const {
    return make_interrogation_grid(columns, rows, windows_[pass], overlap_);
  }
  /// Largest shift looked for along either axis.
  int search_radius_px(int pass) const { return windows_[pass] / (pass == 0 ? 2 : 4); }
  /// A predictor that is off by half a pixel does no harm, one that has lost a steep gradient does: only gross errors
  /// are taken out between passes.
  ValidationRule rule(int pass) const;
  WindowWeighting weighting() const { return weighting_; }
  int spline_degree() const { return spline_degree_; }

 private:
  std::vector<int> windows_;
  double overlap_;
  ValidationRule last_rule_;
  WindowWeighting weighting_;
  int spline_degree_;
};

/// Checks that a pair of images suits the settings. @throws DataError
void check_image_sizes(CorrelationSettings const& settings, int reference_columns, int reference_rows, int flow_columns,
                       int flow_rows);

/// A window's result as a vector to be validated.
GLADSTONE_HD inline GridVector grid_vector(WindowCorrelation const& window) {
  GridVector vector;
  if (window.outcome == WindowCorrelation::Outcome::masked) vector.status = VectorStatus::masked;
  if (window.outcome != WindowCorrelation::Outcome::measured) return vector;
  vector.status = VectorStatus::valid;
  vector.displacement = window.shift[0];
  vector.alternative_count = window.peaks - 1;
  for (int k = 1; k < window.peaks; ++k) vector.alternatives[k - 1] = window.shift[k];
  return vector;
}

/// What a correlation tells of one vector; NaN where it is not known.
struct MeasuredVector {
  Vec2d displacement;  ///< [px]
  double peak_ratio;
  VectorStatus status;
};

GLADSTONE_HD inline MeasuredVector measured_vector(GridVector const& vector, WindowCorrelation const& window) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  bool const measured = window.outcome == WindowCorrelation::Outcome::measured;
  return {is_sound(vector.status) ? vector.displacement : Vec2d{nan, nan}, measured ? window.peak_ratio : nan,
          vector.status};
}

/// The result of the last pass. @param vectors one for each of the grid's windows
DisplacementField displacement_field(InterrogationGrid const& grid, std::span<MeasuredVector const> vectors);

/// The weighting by its name. @pre "gaussian" or "uniform"
WindowWeighting window_weighting(CorrelationSettings const& settings);

}  // namespace gladstone
