#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/correlation/window_measurement.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/frame_pair.h"
#include "render/base/host_device.h"

namespace gladstone::inline correlation {

/// Creates a multi-pass cross-correlator for the CPU. Each pass deforms both images by the validated and smoothed
/// result of the previous pass, correlates smaller windows, and adds the residual displacement. The first pass searches
/// shifts of up to half a window, later passes up to a quarter of a window. Smoothing applies to the predictors only,
/// not to the result. Where displacement gradients are steep, the last pass is repeated, see steep_refinement.h.
std::unique_ptr<Correlator> make_standard_correlator(CorrelationSettings const& settings);

/// Sequence of image pairs with a common displacement field, indexed from 0. Each pair is requested once per pass.
struct PairSequence {
  std::size_t size = 0;
  std::function<HostFrames(std::size_t pair)> frames;
};

/// Measures the displacement field common to all pairs (ensemble correlation). Each pass finds the peaks in the mean of
/// the pairs' correlation planes, so that few particles or strong noise in single pairs are tolerated. Displacements
/// that differ between pairs are averaged and broaden the peak. Meinhart, Wereley & Santiago, J. Fluids Eng. 122 (2000)
/// 285.
/// @return vectors as described at Correlator::correlate(); they are computed on the CPU
/// @throws DataError if sizes differ, a window does not fit into the image, or the method or the uncertainty estimator
/// applies to single pairs only
DisplacementField correlate_ensemble(PairSequence const& pairs, CorrelationSettings const& settings);

/// Sequence of passes and their parameters, common to the CPU and the CUDA correlator.
class CorrelationSchedule {
 public:
  /// @pre at least one window and one final pass
  explicit CorrelationSchedule(CorrelationSettings const& settings);

  int passes() const { return static_cast<int>(windows_.size()); }
  bool is_last(int pass) const { return pass + 1 == passes(); }
  /// Returns the windows of a pass: the grid of the vectors for the last pass, otherwise a grid centred on the image,
  /// so that mirrored frames have mirrored predictors.
  InterrogationGrid grid(int pass, int columns, int rows) const {
    return is_last(pass) ? make_interrogation_grid(columns, rows, windows_[pass], overlap_)
                         : make_centred_grid(columns, rows, windows_[pass], overlap_);
  }
  /// Returns the largest shift searched along either axis [px].
  int search_radius_px(int pass) const;
  /// Returns the validation rule of a pass. Before the last pass, only gross errors are removed: a predictor error of
  /// half a pixel is harmless, the loss of a steep gradient is not. Only in the first pass can a high peak ratio
  /// outweigh the neighbours: later passes search a few pixels only, where a random peak rarely has competitors.
  ValidationRule rule(int pass) const;
  /// Returns the largest number of additional runs of the last pass where displacement gradients are steep, see
  /// refine_steep_vectors(); 0 for a single pass, which deforms nothing, and for phase correlations, whose peak heights
  /// do not measure how well the frames match.
  int steep_passes() const { return steep_passes_; }
  /// Returns the smoothing weight of the predictors of these additional passes: half of the smoothing() of the last
  /// predictor, so that displacement waves that are hardly longer than the window converge.
  double steep_smoothing() const { return 0.5 * smoothing(passes() - 1); }
  /// Returns the weight that smoothed() gives to a node's two neighbours along an axis when a pass's vectors become a
  /// predictor: 1/4 for the last predictor and for the deformation of the frames by the result itself, and less on
  /// wider grids, in inverse proportion to their spacing.
  /// For nodes at distance d and a smoothing weight s, a displacement wave of length L retains the fraction 1 - s (1 -
  /// cos(2 pi d/L)) of its amplitude. A weight of 1/4 on wide grids would remove the wavelengths that their passes have
  /// to resolve, and is not needed there because large windows have little noise.
  double smoothing(int pass) const;
  /// Returns the largest displacement along either axis [px]; infinite if only the window sizes limit it.
  double limit_px() const { return last_rule_.limit_px; }
  WindowWeighting weighting() const { return weighting_; }
  int spline_degree() const { return spline_degree_; }

 private:
  std::vector<int> windows_;
  double overlap_;
  ValidationRule last_rule_;
  WindowWeighting weighting_;
  int spline_degree_;
  int steep_passes_;
};

/// Checks that the two images have the same size and that the windows fit into them. @throws DataError
void check_image_sizes(CorrelationSettings const& settings, int reference_columns, int reference_rows, int flow_columns,
                       int flow_rows);

/// View of flags that mark the ambiguous vectors of the previous pass.
struct AmbiguousPlaces {
  InterrogationGrid grid;
  char const* flag;  ///< one flag per vector; null in the first pass

  /// Returns whether one of the windows nearest to a position is flagged; all equally near windows count.
  GLADSTONE_HD bool at(Vec2d position_px) const {
    if (flag == nullptr) return false;
    InterrogationGrid::Range const x = grid.nearest(GridAxis::x, position_px.x),
                                   y = grid.nearest(GridAxis::y, position_px.y);
    for (int row = y.first; row <= y.last; ++row)
      for (int column = x.first; column <= x.last; ++column)
        if (flag[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) +
                 static_cast<std::size_t>(column)] != 0)
          return true;
    return false;
  }
};

/// Converts the result of a window to a vector for validation: the first peak within the limit gives the displacement,
/// the following peaks are its alternatives.
/// @param predictor  predictor of the pass at the window's centre [px]
/// @param limit_px  largest displacement along either axis, predictor included
/// @param ambiguous  whether the previous pass was ambiguous here
GLADSTONE_HD inline GridVector grid_vector(WindowCorrelation const& window, Vec2d predictor, double limit_px,
                                           bool ambiguous) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  GridVector vector;
  vector.predictor = predictor;
  vector.raw = {nan, nan};
  if (ambiguous) vector.ambiguous = Ambiguity::earlier;
  if (window.outcome == WindowCorrelation::Outcome::masked) {
    vector.status = VectorStatus::masked;
    vector.reason = VectorReason::masked;
  }
  if (window.outcome == WindowCorrelation::Outcome::masked || window.outcome == WindowCorrelation::Outcome::no_signal)
    return vector;
  vector.reason = VectorReason::beyond_limit;
  for (int k = 0; k < window.peaks; ++k) {
    Vec2d const whole = predictor + window.shift[k];
    if (!is_within(whole, limit_px)) continue;
    if (vector.status == VectorStatus::valid) {
      vector.alternatives[vector.alternative_count++] = whole;
      if (window.coefficient[k] >= ambiguous_height_ratio * vector.correlation) vector.ambiguous = Ambiguity::here;
      continue;
    }
    vector.status = VectorStatus::valid;
    vector.reason = VectorReason::measured;
    vector.displacement = vector.raw = whole;
    vector.correlation = window.coefficient[k];
    vector.peak_ratio = k == 0 ? window.peak_ratio : 0.0;
  }
  return vector;
}

/// Result for one vector of the field; NaN: not measured.
struct MeasuredVector {
  Vec2d displacement;  ///< displacement after validation; NaN unless valid or replaced [px]
  Vec2d raw;           ///< displacement before replacement [px]
  double peak_ratio;
  double correlation;
  VectorStatus status;
  VectorReason reason;
  FailedTest failed;
  Ambiguity ambiguous;
};

GLADSTONE_HD inline MeasuredVector measured_vector(GridVector const& vector, WindowCorrelation const& window) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  bool const measured = is_measured(vector);
  MeasuredVector result;
  result.displacement = is_valid_or_replaced(vector.status) ? vector.displacement : Vec2d{nan, nan};
  result.raw = vector.raw;
  result.peak_ratio = window.outcome == WindowCorrelation::Outcome::measured ? window.peak_ratio : nan;
  result.correlation = measured ? (vector.correlation < 1.0 ? vector.correlation : 1.0) : nan;
  result.status = vector.status;
  result.reason = vector.reason;
  result.failed = vector.failed;
  result.ambiguous = measured ? vector.ambiguous : Ambiguity::none;
  return result;
}

/// Converts the vectors of the last pass to a displacement field.
/// @param vectors  one per window of the grid
DisplacementField displacement_field(InterrogationGrid const& grid, std::span<MeasuredVector const> vectors);

/// Returns the weighting of that name. @pre settings.weighting is "gaussian" or "uniform"
WindowWeighting window_weighting(CorrelationSettings const& settings);

}  // namespace gladstone::inline correlation
