#pragma once

#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/peak_search.cuh"

/// What a window's plane leaves behind, by the block that made it.
namespace gladstone::cuda {

/// Leaves that there is nothing to measure.
__device__ inline void leave_nothing(WindowCorrelation::Outcome why, WindowPeaks& peaks) {
  peaks.outcome = why;
  peaks.count = 0;
  peaks.scale = 0.0;
  for (PeakSample& sample : peaks.peak) sample = {};  // measure_peaks reads the heights of absent peaks, too
}

/// Leaves the highest peaks. By one full warp. @param shares the highest of each part of the plane
/// @param list room for all maxima @param found for the case that the shares do not suffice
template <class Plane>
__device__ void leave_peaks(Plane const& plane, int radius, HighestPeaks const* shares, int share_count,
                            PlanePeak<float>* list, PeakList<float>& found, double scale, WindowPeaks& peaks) {
  int const lane = static_cast<int>(threadIdx.x % 32u);
  PlanePeak<float> peak;
  int const count = join_shares(plane, radius, shares, share_count, list, found, peak);
  if (lane < PeakList<float>::capacity) {
    bool const there = lane < count;
    int const dx = there ? peak.x : 0, dy = there ? peak.y : 0;
    peaks.peak[lane] = {dx,
                        dy,
                        there ? peak.height : 0.0f,
                        plane(dx, dy),
                        plane(dx - 1, dy),
                        plane(dx + 1, dy),
                        plane(dx, dy - 1),
                        plane(dx, dy + 1)};
  }
  if (lane == 0) {
    peaks.outcome = WindowCorrelation::Outcome::measured;
    peaks.count = count;
    peaks.scale = scale;
  }
}

}  // namespace gladstone::cuda
