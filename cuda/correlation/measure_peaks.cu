#include "analysis/correlation/subpixel/gaussian_fits.h"
#include "analysis/correlation/window_peak.h"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/device/cuda_error.h"

/// Subpixel measurement of the peaks of all windows.
namespace gladstone::cuda::inline correlation {
namespace {

/// Samples around a peak as a plane of correlation coefficients.
struct SampledPlane {
  PeakSample const& sample;
  double scale;
  __device__ double operator()(int x, int y) const { return scale * sample.value[y - sample.y + 1][x - sample.x + 1]; }
};

/// Measures one peak per thread; the peaks of a window are processed by adjacent threads.
template <class Fit>
__global__ void measure_peak(WindowJob const job, WindowPeaks const* all_peaks, WindowCorrelation* results) {
  constexpr int parts = PeakList<float>::capacity;
  long long const at = static_cast<long long>(blockIdx.x) * blockDim.x + threadIdx.x;
  long long const window = at / parts;
  if (window >= static_cast<long long>(job.grid.size())) return;
  int const which = static_cast<int>(at % parts);
  int const column = static_cast<int>(window % job.grid.columns), row = static_cast<int>(window / job.grid.columns);
  WindowPeaks const& peaks = all_peaks[window];
  WindowCorrelation& result = results[window];
  MeasuredPeak peak{};
  if (which < peaks.count) {
    SampledPlane const plane{peaks.peak[which], peaks.scale};
    peak = fitted_peak(Fit(), plane, plane.sample.x, plane.sample.y, job.x, column, job.y, row);
  }
  result.shift[which] = peak.shift;
  result.coefficient[which] = peak.coefficient;
  if (which != 0) return;
  double const second = peaks.count > 1 ? peaks.scale * peaks.peak[1].height : 0.0;
  double const third = peaks.count > 2 ? peaks.scale * peaks.peak[2].height : 0.0;
  result.peaks = peaks.count;
  result.peak_ratio = peaks.count > 0 ? peak_ratio(peaks.scale * peaks.peak[0].height, second, third) : 0.0;
  using Outcome = WindowCorrelation::Outcome;
  result.outcome = peaks.outcome == Outcome::measured && peaks.count == 0 ? Outcome::no_peak : peaks.outcome;
}

}  // namespace

void measure_peaks(WindowJob const& job, WindowPeaks const* peaks, bool nine_points, WindowCorrelation* results) {
  constexpr unsigned threads = 192;
  auto const parts = PeakList<float>::capacity * job.grid.size();
  auto* const kernel = nine_points ? measure_peak<GaussOfAnyAxes> : measure_peak<GaussAlongAxes>;
  kernel<<<static_cast<unsigned>((parts + threads - 1) / threads), threads>>>(job, peaks, results);
  check_launch("measure_peak");
}

bool has_own_kernel(WindowJob const& job) {
  return job.particles == nullptr && job.side == job.size && (job.size == 32 || job.size == 64);
}

}  // namespace gladstone::cuda::inline correlation
