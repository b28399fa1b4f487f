#pragma once

#include <vector>

#include "analysis/correlation/lane_correlation.h"
#include "analysis/correlation/peak_search.h"

namespace gladstone::inline correlation {

/// Finds and measures the peaks of eight correlation planes in SIMD lanes, with the same results as find_peaks() and
/// fitted_peak().
class LanePeaks {
 public:
  /// @param decreases_with_shift  whether the planes decrease with the shift like the autocorrelation of the weights
  LanePeaks(InterrogationJob const& job, bool decreases_with_shift);

  /// Finds and measures the peaks of the first `count` windows.
  /// @param outcome  outcome of each window so far: only measured ones have a plane
  /// @param results  output: `count` windows
  void pick(LaneCorrelation const& work, LanePlane const& plane, WindowCorrelation::Outcome const* outcome, int count,
            WindowCorrelation* results);

 private:
  void find_maxima(LanePlane const& plane);
  float third_highest(int lane) const;
  template <class Visit>
  void visit_high(int lane, float least, Visit const& visit) const;
  PeakList<float> rank(LanePlane const& plane, int lane);
  MeasuredPeak measure(LaneCorrelation const& work, LanePlaneView const& plane, int x, int y) const;
  void measure_all(LaneCorrelation const& work, LanePlane const& plane, int p, PeakList<float> const* found,
                   WindowCorrelation* results) const;

  InterrogationJob const& job_;
  bool decreases_with_shift_;
  // [above, here, below][column] highest of three adjacent values in a row of the plane, for three successive rows
  std::vector<FloatLanes> highest_[3];
  std::vector<unsigned char> found_;  // maxima in a row: one byte per column with one bit per lane
  int counts_[lane_count] = {};
  std::vector<PlanePeak<float>> maxima_[lane_count];  // maxima of each lane, in reading order
  std::vector<float> heights_[lane_count];            // heights of maxima_, followed by zeros
  std::vector<PlanePeak<float>> refined_;             // maxima of one window with interpolated heights
};

}  // namespace gladstone::inline correlation
