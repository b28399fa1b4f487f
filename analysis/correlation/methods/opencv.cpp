#include <algorithm>
#include <complex>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/fourier_transform.h"
#include "analysis/correlation/lane_fourier.h"
#include "analysis/correlation/window_peak.h"
#include "analysis/correlation/window_pixels.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t windows_per_chunk = 32;  // even, since windows are transformed in pairs

/// Correlation of windows in pairs, with scratch memory for one pair.
class PairwiseCorrelation {
 public:
  PairwiseCorrelation(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y)
      : job_(job), pair_(job.pair), grid_(job.grid), x_(x), y_(y), size_(lane_fourier_size(x.size)) {
    std::size_t const values = static_cast<std::size_t>(size_) * size_;
    window_.resize(values);
    spectrum_[0].resize(values);
    spectrum_[1].resize(values);
  }

  void operator()(std::size_t begin, std::size_t end, std::vector<WindowCorrelation>& results) {
    for (std::size_t i = begin; i < end; i += 2) {
      int const count = i + 1 < end ? 2 : 1;
      double scale[2] = {0.0, 0.0};
      for (int k = 0; k < count; ++k) {
        scale[k] = load(i + k, results[i + k]);
        if (scale[k] > 0.0) fourier_transform(window_, spectrum_[k], size_, FourierDirection::forward);
      }
      if (scale[0] == 0.0 && scale[1] == 0.0) continue;
      join(scale);
      fourier_transform(window_, spectrum_[0], size_, FourierDirection::inverse);
      for (int k = 0; k < count; ++k)
        if (scale[k] > 0.0) pick(i + k, reinterpret_cast<double const*>(spectrum_[0].data()) + k, results[i + k]);
    }
  }

 private:
  /// Fills window_ and returns the factor that converts the plane to a correlation coefficient; 0 if there is no signal
  /// or the window is masked.
  double load(std::size_t index, WindowCorrelation& result) {
    int const column = static_cast<int>(index % static_cast<std::size_t>(grid_.columns));
    int const row = static_cast<int>(index / static_cast<std::size_t>(grid_.columns));
    WindowSums<double> sums;
    visit_window_pixels(pair_, x_, column, y_, row, [&](int, int, double weight, std::size_t at) {
      sums += {weight, weight * pair_.reference[at], weight * pair_.flow[at]};
    });
    if (sums.weight < min_valid_weight_fraction * x_.sum(column) * y_.sum(row)) {
      result.outcome = WindowCorrelation::Outcome::masked;
      return 0.0;
    }
    double const mean_reference = sums.reference / sums.weight, mean_flow = sums.flow / sums.weight;
    int const core_begin = grid_.window_px / 2, core_end = core_begin + grid_.window_px;
    double energy[2] = {}, core_energy[2] = {};  // energies of frame A and of frame B
    std::fill(window_.begin(), window_.end(), 0.0);
    visit_window_pixels(pair_, x_, column, y_, row, [&](int i, int j, double weight, std::size_t at) {
      double const value[2] = {weight * (pair_.reference[at] - mean_reference), weight * (pair_.flow[at] - mean_flow)};
      window_[static_cast<std::size_t>(j) * size_ + i] = {value[0], value[1]};
      bool const in_core = std::min(i, j) >= core_begin && std::max(i, j) < core_end;
      for (int k = 0; k < 2; ++k) {
        energy[k] += value[k] * value[k];
        if (in_core) core_energy[k] += value[k] * value[k];
      }
    });
    auto const single = [](double sum) { return static_cast<float>(sum); };
    double const scale =
        plane_scale({single(energy[0]), single(energy[1]), single(core_energy[0]), single(core_energy[1])},
                    pair_.contrast, grid_.window_px, size_);
    if (scale == 0.0) result.outcome = WindowCorrelation::Outcome::no_signal;
    return scale;
  }

  /// Writes the cross spectra of both windows, C0 + i C1, to window_. If a window of the pair is missing, its scale is
  /// 0 and its spectrum is a finite one from an earlier call.
  void join(double const* scale) {
    int const size = size_;
    double const scale0 = scale[0], scale1 = scale[1];
    for (int j = 0; j <= size / 2; ++j) {
      // The rows j = 0 and size/2 are their own mirrors: each column is written twice, with equal values.
      std::size_t const row = 2 * static_cast<std::size_t>(j) * size;
      std::size_t const mirror_row = 2 * static_cast<std::size_t>((size - j) % size) * size;
      double const* const z0 = reinterpret_cast<double const*>(spectrum_[0].data()) + row;
      double const* const m0 = reinterpret_cast<double const*>(spectrum_[0].data()) + mirror_row;
      double const* const z1 = reinterpret_cast<double const*>(spectrum_[1].data()) + row;
      double const* const m1 = reinterpret_cast<double const*>(spectrum_[1].data()) + mirror_row;
      double* const out = reinterpret_cast<double*>(window_.data()) + row;
      double* const mirror_out = reinterpret_cast<double*>(window_.data()) + mirror_row;
      auto const join_column = [&](int i, int m) {
        Vec2<double> const c0 = scale0 * cross_spectrum(z0[i], z0[i + 1], m0[m], m0[m + 1]);
        Vec2<double> const c1 = scale1 * cross_spectrum(z1[i], z1[i + 1], m1[m], m1[m + 1]);
        out[i] = c0.x - c1.y;
        out[i + 1] = c0.y + c1.x;
        mirror_out[m] = c0.x + c1.y;
        mirror_out[m + 1] = c1.x - c0.y;
      };
      join_column(0, 0);
      for (int i = 1; i < size; ++i) join_column(2 * i, 2 * (size - i));
    }
  }

  void pick(std::size_t index, double const* values, WindowCorrelation& result) const {
    int const column = static_cast<int>(index % static_cast<std::size_t>(grid_.columns));
    int const row = static_cast<int>(index / static_cast<std::size_t>(grid_.columns));
    PlaneView<double> const plane{values, size_, 2};
    PeakList<double> const found = find_peaks(plane, job_.search_radius_px);
    if (found.count == 0) {
      result.outcome = WindowCorrelation::Outcome::no_peak;
      return;
    }
    result.outcome = WindowCorrelation::Outcome::measured;
    result.peaks = found.count;
    for (int p = 0; p < found.count; ++p) {
      // The values of the plane are correlation coefficients, since join() has scaled the spectrum.
      MeasuredPeak const peak = fitted_peak(job_.fit, plane, found.peak[p].x, found.peak[p].y, x_, column, y_, row);
      result.shift[p] = peak.shift;
      result.coefficient[p] = peak.coefficient;
    }
    result.peak_ratio = peak_ratio(found.peak[0].height, found.peak[1].height, found.peak[2].height);
  }

  InterrogationJob const& job_;
  ImagePair const& pair_;
  InterrogationGrid const& grid_;
  AxisWeightsView x_;
  AxisWeightsView y_;
  int size_;  ///< length of the transforms
  std::vector<std::complex<double>> window_;
  std::vector<std::complex<double>> spectrum_[2];
};

}  // namespace

/// Computes the planes of method "scc" by OpenCV's transforms in double precision, two windows at a time. The transform
/// length is twice the window or the next larger length that "scc" can use, so that Gaussian windows wrap around at
/// their rim in the same way. Slow; used as the reference for the faster methods.
std::vector<WindowCorrelation> correlate_by_opencv(InterrogationJob const& job) {
  InterrogationGrid const& grid = job.grid;
  int const radius = job.search_radius_px;
  GLADSTONE_EXPECTS(radius > 0 && 2 * radius <= grid.window_px && grid.window_px % 2 == 0);
  AxisWeights const x(grid, GridAxis::x, job.pair.columns, job.weighting);
  AxisWeights const y(grid, GridAxis::y, job.pair.rows, job.weighting);
  std::vector<WindowCorrelation> results(grid.size());
  Progress progress(job.label, grid.size());
  parallel_chunks(grid.size(), windows_per_chunk, [&](std::size_t begin, std::size_t end) {
    PairwiseCorrelation correlation(job, x.view(), y.view());
    correlation(begin, end, results);
    progress.advance(end - begin);
  });
  return results;
}

}  // namespace gladstone::inline correlation
