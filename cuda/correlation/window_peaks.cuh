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

/// Leaves peaks with what is around them. By one full warp. @param peak in lane k < count the k-th
template <class Plane>
__device__ void leave_samples(Plane const& plane, int count, PlanePeak<float> const& peak, double scale,
                              WindowPeaks& peaks) {
  int const lane = static_cast<int>(threadIdx.x % 32u);
  if (lane < PeakList<float>::capacity) {
    bool const there = lane < count;
    PeakSample sample{there ? peak.x : 0, there ? peak.y : 0, there ? peak.height : 0.0f, {}};
#pragma unroll
    for (int k = 0; k < 9; ++k) sample.value[k / 3][k % 3] = plane(sample.x + k % 3 - 1, sample.y + k / 3 - 1);
    peaks.peak[lane] = sample;
  }
  if (lane == 0) {
    peaks.outcome = WindowCorrelation::Outcome::measured;
    peaks.count = count;
    peaks.scale = scale;
  }
}

/// Leaves the highest peaks. By one full warp. @param shares the highest of each part of the plane
/// @param list room for all maxima @param found for the case that the shares do not suffice
template <class Plane>
__device__ void leave_peaks(Plane const& plane, int radius, HighestPeaks const* shares, int share_count,
                            PlanePeak<float>* list, PeakList<float>& found, double scale, WindowPeaks& peaks) {
  PlanePeak<float> peak;
  int const count = join_shares(plane, radius, shares, share_count, list, found, peak);
  leave_samples(plane, count, peak, scale, peaks);
}

}  // namespace gladstone::cuda
