#pragma once

#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/peak_search.cuh"

/// Output of the peaks of a window, by the thread block that computed its correlation plane.
namespace gladstone::cuda::inline correlation {

/// Writes the result of a window that was not correlated.
__device__ inline void write_no_result(WindowCorrelation::Outcome why, WindowPeaks& peaks) {
  peaks.outcome = why;
  peaks.count = 0;
  peaks.scale = 0.0;
  // Clear the samples of all peaks, so that none is uninitialised memory.
  for (PeakSample& sample : peaks.peak) sample = {};
}

/// Writes peaks with their surrounding samples. Called by one full warp. @param peak  the k-th peak in lane k < count
template <class Plane>
__device__ void write_peak_samples(Plane const& plane, int count, PlanePeak<float> const& peak, double scale,
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

/// Writes the highest peaks. Called by one full warp.
/// @param shares  highest maxima of each part of the plane
/// @param list  capacity for all maxima
/// @param found  memory for the slow search
template <class Plane>
__device__ void write_peaks(Plane const& plane, int radius, HighestPeaks const* shares, int share_count,
                            PlanePeak<float>* list, PeakList<float>& found, double scale, WindowPeaks& peaks) {
  PlanePeak<float> peak;
  int const count = join_shares(plane, radius, shares, share_count, list, found, peak);
  write_peak_samples(plane, count, peak, scale, peaks);
}

}  // namespace gladstone::cuda::inline correlation
