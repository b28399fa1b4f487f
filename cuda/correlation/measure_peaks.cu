#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/peak_search.cuh"
#include "cuda/device/cuda_error.h"

/// From the peaks of every window to shifts between the pixels.
namespace gladstone::cuda {
namespace {

/// The five values as a plane.
struct SampledPlane {
  PeakSample sample;
  __device__ float operator()(int x, int y) const {
    int const dx = x - sample.x, dy = y - sample.y;
    if (dx != 0) return dx < 0 ? sample.left : sample.right;
    return dy == 0 ? sample.centre : (dy < 0 ? sample.above : sample.below);
  }
};

/// Place and height of one peak, thread by thread: peaks, then windows.
__global__ void measure_peaks(WindowJob const job, WindowPeaks const* all_peaks) {
  constexpr int parts = PeakList<float>::capacity;
  long long const at = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  long long const window = at / parts;
  if (window >= static_cast<long long>(job.grid.size())) return;
  int const which = static_cast<int>(at % parts);
  int const column = static_cast<int>(window % job.grid.columns), row = static_cast<int>(window / job.grid.columns);
  WindowPeaks const& peaks = all_peaks[window];
  WindowCorrelation& result = job.results[window];
  MeasuredPeak peak{};
  if (which < peaks.count) {
    SampledPlane const plane{peaks.peak[which]};
    peak = measured_peak(plane, plane.sample.x, plane.sample.y, peaks.scale, job.x, column, job.y, row);
  }
  result.shift[which] = peak.shift;
  result.coefficient[which] = peak.coefficient;
  if (which != 0) return;
  write_outcome(peaks.count, {peaks.peak[0].height, peaks.peak[1].height, peaks.peak[2].height}, peaks.scale, result);
  if (peaks.outcome != WindowCorrelation::Outcome::measured) result.outcome = peaks.outcome;
}

}  // namespace

bool has_own_kernel(int size) { return size == 32 || size == 64; }

void correlate_small_windows(WindowJob const& job, WindowPeaks* peaks) {
  if (job.x.size == 64)
    correlate_windows_of_64(job, peaks);
  else
    correlate_windows_of_32(job, peaks);
  constexpr unsigned threads = 192;
  auto const parts = PeakList<float>::capacity * job.grid.size();
  measure_peaks<<<static_cast<unsigned>((parts + threads - 1) / threads), threads>>>(job, peaks);
  check_launch("measure_peaks");
}

}  // namespace gladstone::cuda
