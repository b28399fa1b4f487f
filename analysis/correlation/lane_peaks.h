#pragma once

#include <vector>

#include "analysis/correlation/lane_correlation.h"
#include "analysis/correlation/peak_search.h"

namespace gladstone {

/// Finds and measures the peaks of eight planes at a time: what find_peaks() finds, with the maxima looked for and
/// refined side by side.
class LanePeaks {
 public:
  /// @param falls_off whether the planes fall off with the shift as the windows' common weight does
  LanePeaks(InterrogationJob const& job, bool falls_off);

  /// @param outcome of each window so far: only those that are measured have a plane
  /// @param results receives `count` windows
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
  bool falls_off_;
  std::vector<FloatLanes> highest_[3];  // of three values beside each other, of the rows above, here and below
  std::vector<unsigned char> found_;    // of a row, one bit a lane
  int counts_[lane_count] = {};
  std::vector<PlanePeak<float>> maxima_[lane_count];  // in reading order
  std::vector<float> heights_[lane_count];            // of these, and 0 behind them
  std::vector<PlanePeak<float>> refined_;             // those of a window whose height between the samples is known
};

}  // namespace gladstone
