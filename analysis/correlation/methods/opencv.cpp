#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/fourier_plan.h"
#include "analysis/correlation/known_tiles.h"
#include "analysis/correlation/lane_fourier.h"
#include "analysis/correlation/window_peak.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"

namespace gladstone {
namespace {

constexpr std::size_t windows_per_chunk = 32;  // even, since windows are transformed in pairs

/// Correlates windows two at a time, with its own scratch memory.
class PairwiseCorrelation {
 public:
  PairwiseCorrelation(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                      KnownTiles const& tiles)
      : job_(job),
        pair_(job.pair),
        grid_(job.grid),
        x_(x),
        y_(y),
        tiles_(tiles),
        plan_(make_fourier_plan(lane_fourier_size(x.size))) {
    std::size_t const values = static_cast<std::size_t>(plan_->size()) * plan_->size();
    pixels_.resize(values);
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
        if (scale[k] > 0.0) plan_->forward(window_.data(), spectrum_[k].data());
      }
      if (scale[0] == 0.0 && scale[1] == 0.0) continue;
      join(scale);
      plan_->inverse(window_.data(), spectrum_[0].data());
      for (int k = 0; k < count; ++k)
        if (scale[k] > 0.0) pick(i + k, reinterpret_cast<double const*>(spectrum_[0].data()) + k, results[i + k]);
    }
  }

 private:
  /// Fills window_ and returns the factor that converts the plane to a correlation coefficient; 0 if there is no signal
  /// or the window is masked.
  double load(std::size_t index, WindowCorrelation& result) {
    int const size = x_.size, pitch = plan_->size();
    int const column = static_cast<int>(index % static_cast<std::size_t>(grid_.columns));
    int const row = static_cast<int>(index / static_cast<std::size_t>(grid_.columns));
    WindowView<float> view{};
    view.reference = pair_.reference.data();
    view.flow = pair_.flow.data();
    view.columns = pair_.columns;
    view.size = size;
    view.first_x = x_.first(column);
    view.first_y = y_.first(row);
    view.begin_x = std::max(0, -view.first_x);
    view.end_x = std::min(size, pair_.columns - view.first_x);
    view.begin_y = std::max(0, -view.first_y);
    view.end_y = std::min(size, pair_.rows - view.first_y);
    view.core_begin = grid_.window_px / 2;
    view.core_end = view.core_begin + grid_.window_px;
    view.weight_x = x_.weight(column);
    view.weight_y = y_.weight(row);
    bool const complete = tiles_.all_known(view.first_x + view.begin_x, view.first_y + view.begin_y,
                                           view.first_x + view.end_x, view.first_y + view.end_y);
    view.available = complete ? nullptr : pair_.available.data();

    WindowSums<float> sums;
    for (int j = view.begin_y; j < view.end_y; ++j) sums += sum_row(view, j);
    if (!complete && sums.weight < min_valid_weight_fraction * x_.sum(column) * y_.sum(row)) {
      result.outcome = WindowCorrelation::Outcome::masked;
      return 0.0;
    }
    float const mean_reference = sums.reference / sums.weight, mean_flow = sums.flow / sums.weight;
    float* out = reinterpret_cast<float*>(pixels_.data());
    std::fill(out, out + 2 * pixels_.size(), 0.0f);
    WindowEnergy<float> energy;
    for (int j = view.begin_y; j < view.end_y; ++j)
      energy += load_row(view, j, mean_reference, mean_flow, out + 2 * static_cast<std::size_t>(j) * pitch);
    std::copy(pixels_.begin(), pixels_.end(), window_.begin());
    double const scale = plane_scale(energy, pair_.contrast, grid_.window_px, pitch);
    if (scale == 0.0) result.outcome = WindowCorrelation::Outcome::no_signal;
    return scale;
  }

  /// Writes the cross spectra of both windows, C0 + i C1, to window_. A missing window has scale 0 and a finite
  /// spectrum from an earlier call.
  void join(double const* scale) {
    int const size = plan_->size();
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
    PlaneView<double> const plane{values, plan_->size(), 2};
    PeakList<double> const found = find_peaks(plane, job_.search_radius_px);
    if (found.count == 0) {
      result.outcome = WindowCorrelation::Outcome::no_peak;
      return;
    }
    result.outcome = WindowCorrelation::Outcome::measured;
    result.peaks = found.count;
    for (int p = 0; p < found.count; ++p) {
      // The plane already includes the scale, by join().
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
  KnownTiles const& tiles_;
  std::unique_ptr<FourierPlan> plan_;
  std::vector<std::complex<float>> pixels_;
  std::vector<std::complex<double>> window_;
  std::vector<std::complex<double>> spectrum_[2];
};

}  // namespace

/// Computes the planes of scc by OpenCV's transforms in double precision, two windows at a time. The transform length
/// is twice the window or the next larger length available to scc, so that Gaussian windows wrap around at their rim in
/// the same way. Slow; used as the reference for the faster methods.
std::vector<WindowCorrelation> correlate_by_opencv(InterrogationJob const& job) {
  InterrogationGrid const& grid = job.grid;
  int const radius = job.search_radius_px;
  GLADSTONE_EXPECTS(radius > 0 && 2 * radius <= grid.window_px && grid.window_px % 2 == 0);
  AxisWeights const x(grid, GridAxis::x, job.pair.columns, job.weighting);
  AxisWeights const y(grid, GridAxis::y, job.pair.rows, job.weighting);
  KnownTiles const tiles(job.pair);
  std::vector<WindowCorrelation> results(grid.size());
  Progress progress(job.label, grid.size());
  parallel_chunks(grid.size(), windows_per_chunk, [&](std::size_t begin, std::size_t end) {
    PairwiseCorrelation correlation(job, x.view(), y.view(), tiles);
    correlation(begin, end, results);
    progress.advance(end - begin);
  });
  return results;
}

}  // namespace gladstone
