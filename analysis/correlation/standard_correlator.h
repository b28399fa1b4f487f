#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/correlation/window_measurement.h"
#include "analysis/correlation/window_ops.h"
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
  /// Windows of a pass: the last one's where the vectors stand, the others' centred on the image, so that predictors of
  /// mirrored frames are mirrored.
  InterrogationGrid grid(int pass, int columns, int rows) const {
    return is_last(pass) ? make_interrogation_grid(columns, rows, windows_[pass], overlap_)
                         : make_centred_grid(columns, rows, windows_[pass], overlap_);
  }
  /// Largest shift looked for along either axis.
  int search_radius_px(int pass) const;
  /// A predictor that is off by half a pixel does no harm, one that has lost a steep gradient does: only gross errors
  /// are taken out between passes. Only the first pass trusts windows against their neighbours: later ones look for
  /// what is left over a few pixels far, where a chance peak has hardly room for rivals.
  ValidationRule rule(int pass) const;
  /// Part of a node that smoothing takes from its neighbours on either side, along an axis (smoothed()), where a pass's
  /// vectors become a predictor: 1/4 in the last predictor and in the frames that the result itself deforms, less on
  /// wider grids before it, in inverse proportion to their spacing. Nodes d apart keep 1 - part (1 - cos(2 pi d/L)) of
  /// a wave of length L: 1/4 on every grid would cost wide grids the waves that their passes are there to follow, and
  /// their large windows have little noise to lose.
  double smoothing(int pass) const;
  /// Largest displacement along either axis [px]; infinite where there is no limit but the windows'.
  double limit_px() const { return last_rule_.limit_px; }
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

/// Where the pass before could not tell displacements apart: one flag for each of its vectors.
struct AmbiguousPlaces {
  InterrogationGrid grid;
  char const* flag;  ///< null in the first pass

  /// Whether one of the nearest windows was: between windows that are equally near all of them count.
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

/// A window's result as a vector to be validated: the first of its peaks that the limit allows, the next ones as
/// alternatives.
/// @param predictor that the pass was deformed by, at the window's centre [px]
/// @param limit_px  largest displacement along either axis, predictor included
/// @param ambiguous whether the pass before was, here
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
      if (window.coefficient[k] >= nearly_as_high * vector.correlation) vector.ambiguous = Ambiguity::here;
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

/// What a correlation tells of one vector; NaN where it is not known.
struct MeasuredVector {
  Vec2d displacement;  ///< [px]
  Vec2d raw;           ///< before replacement [px]
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
  result.displacement = is_sound(vector.status) ? vector.displacement : Vec2d{nan, nan};
  result.raw = vector.raw;
  result.peak_ratio = window.outcome == WindowCorrelation::Outcome::measured ? window.peak_ratio : nan;
  result.correlation = measured ? (vector.correlation < 1.0 ? vector.correlation : 1.0) : nan;
  result.status = vector.status;
  result.reason = vector.reason;
  result.failed = vector.failed;
  result.ambiguous = measured ? vector.ambiguous : Ambiguity::none;
  return result;
}

/// The result of the last pass.
/// @param vectors one for each of the grid's windows
DisplacementField displacement_field(InterrogationGrid const& grid, std::span<MeasuredVector const> vectors);

/// The weighting by its name. @pre "gaussian" or "uniform"
WindowWeighting window_weighting(CorrelationSettings const& settings);

}  // namespace gladstone
