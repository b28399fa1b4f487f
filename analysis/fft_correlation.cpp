#include "analysis/fft_correlation.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/fourier_plan.h"
#include "analysis/subpixel_peak.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"

namespace gladstone {
namespace {

constexpr std::size_t windows_per_chunk = 32;  // even: windows are transformed in pairs
constexpr double largest_peak_ratio = 1000.0;
/// Contrast (weighted rms over that of the whole image) below which a window is rounding, not signal.
constexpr double smallest_contrast = 1e-6;
/// Part of a window's weight that must be on known pixels.
constexpr double smallest_known_part = 0.5;

/// The weights of the windows along one axis, cut off at the image's border, and their autocorrelation.
class AxisWeights {
 public:
  AxisWeights(InterrogationGrid const& grid, int windows, int image_length, WindowWeighting weighting)
      : size_(2 * grid.window_px) {
    for (int k = 0; k < windows; ++k) {
      int const first = k * grid.spacing_px - grid.window_px / 2;
      first_.push_back(first);
      for (int i = 0; i < size_; ++i) {
        bool const inside = first + i >= 0 && first + i < image_length;
        double const offset = i - 0.5 * (size_ - 1);
        double const weight = axis_weight(weighting, offset, static_cast<double>(grid.window_px));
        weight_.push_back(inside ? static_cast<float>(weight) : 0.0f);
      }
      float const* w = weight_.data() + static_cast<std::size_t>(k) * size_;
      for (int lag = 0; lag < lags(); ++lag) {
        double sum = 0.0;
        for (int i = 0; i + lag < size_; ++i) sum += static_cast<double>(w[i]) * w[i + lag];
        autocorrelation_.push_back(sum);
      }
    }
  }

  int size() const { return size_; }
  int first(int window) const { return first_[window]; }
  float const* weight(int window) const { return weight_.data() + static_cast<std::size_t>(window) * size_; }
  /// Sum of w(i) w(i + lag), |lag| <= size/4 + 1.
  double autocorrelation(int window, int lag) const {
    return autocorrelation_[static_cast<std::size_t>(window) * lags() + std::abs(lag)];
  }

 private:
  int lags() const { return size_ / 4 + 2; }

  int size_;
  std::vector<int> first_;
  std::vector<float> weight_;
  std::vector<double> autocorrelation_;
};

/// Tells quickly whether a rectangle of the image is known throughout.
class KnownTiles {
 public:
  explicit KnownTiles(ImagePair const& pair) : columns_((pair.columns + tile - 1) / tile) {
    if (pair.available.empty()) return;
    known_.assign(static_cast<std::size_t>(columns_) * ((pair.rows + tile - 1) / tile), true);
    for (int j = 0; j < pair.rows; ++j)
      for (int i = 0; i < pair.columns; ++i)
        if (pair.available[static_cast<std::size_t>(j) * pair.columns + i] == 0.0f)
          known_[static_cast<std::size_t>(j / tile) * columns_ + i / tile] = false;
  }

  bool all_known(int first_x, int first_y, int end_x, int end_y) const {
    if (known_.empty()) return true;
    for (int j = first_y / tile; j * tile < end_y; ++j)
      for (int i = first_x / tile; i * tile < end_x; ++i)
        if (!known_[static_cast<std::size_t>(j) * columns_ + i]) return false;
    return true;
  }

 private:
  static constexpr int tile = 16;
  int columns_;
  std::vector<char> known_;
};

/// Correlates windows one pair after the other with its own scratch memory.
class PairwiseCorrelation {
 public:
  PairwiseCorrelation(ImagePair const& pair, InterrogationGrid const& grid, AxisWeights const& x, AxisWeights const& y,
                      KnownTiles const& tiles, int radius)
      : pair_(pair), grid_(grid), x_(x), y_(y), tiles_(tiles), radius_(radius), plan_(make_fourier_plan(x.size())) {
    std::size_t const values = static_cast<std::size_t>(x.size()) * x.size();
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
        if (scale[k] > 0.0) pick(i + k, reinterpret_cast<float const*>(spectrum_[0].data()) + k, results[i + k]);
    }
  }

 private:
  /// Fills window_ and returns the factor that makes the plane a correlation coefficient; 0 where there is nothing
  /// to correlate.
  double load(std::size_t index, WindowCorrelation& result) {
    int const size = x_.size();
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
    if (!complete && sums.weight < smallest_known_part * full_weight(view)) {
      result.outcome = WindowCorrelation::Outcome::masked;
      return 0.0;
    }
    float const mean_reference = sums.reference / sums.weight, mean_flow = sums.flow / sums.weight;
    float* out = reinterpret_cast<float*>(window_.data());
    std::fill(out, out + 2 * static_cast<std::size_t>(view.begin_y) * size, 0.0f);
    std::fill(out + 2 * static_cast<std::size_t>(view.end_y) * size, out + 2 * window_.size(), 0.0f);
    WindowEnergy<float> energy;
    for (int j = view.begin_y; j < view.end_y; ++j)
      energy += load_row(view, j, mean_reference, mean_flow, out + 2 * static_cast<std::size_t>(j) * size);
    double const least = smallest_contrast * pair_.contrast;
    double const faint = least * least * grid_.window_px * grid_.window_px;
    if (!(energy.core_reference > faint && energy.core_flow > faint)) {
      result.outcome = WindowCorrelation::Outcome::no_signal;
      return 0.0;
    }
    return 1.0 / (std::sqrt(static_cast<double>(energy.reference) * energy.flow) * size * size);
  }

  static double full_weight(WindowView<float> const& view) {
    double x = 0.0, y = 0.0;
    for (int i = 0; i < view.size; ++i) {
      x += view.weight_x[i];
      y += view.weight_y[i];
    }
    return x * y;
  }

  /// Writes the cross spectra of both windows, C0 + i C1, to window_. An absent window has scale 0 and a finite
  /// spectrum left over from before.
  void join(double const* scale) {
    int const size = x_.size();
    float const scale0 = static_cast<float>(scale[0]), scale1 = static_cast<float>(scale[1]);
    for (int j = 0; j <= size / 2; ++j) {
      // the rows j = 0 and size/2 are their own mirrors: each column is then written twice, with equal values
      std::size_t const row = 2 * static_cast<std::size_t>(j) * size;
      std::size_t const mirror_row = 2 * static_cast<std::size_t>((size - j) % size) * size;
      float const* const z0 = reinterpret_cast<float const*>(spectrum_[0].data()) + row;
      float const* const m0 = reinterpret_cast<float const*>(spectrum_[0].data()) + mirror_row;
      float const* const z1 = reinterpret_cast<float const*>(spectrum_[1].data()) + row;
      float const* const m1 = reinterpret_cast<float const*>(spectrum_[1].data()) + mirror_row;
      float* const out = reinterpret_cast<float*>(window_.data()) + row;
      float* const mirror_out = reinterpret_cast<float*>(window_.data()) + mirror_row;
      auto const join_column = [&](int i, int m) {
        Vec2<float> const c0 = scale0 * cross_spectrum(z0[i], z0[i + 1], m0[m], m0[m + 1]);
        Vec2<float> const c1 = scale1 * cross_spectrum(z1[i], z1[i + 1], m1[m], m1[m + 1]);
        out[i] = c0.x - c1.y;
        out[i + 1] = c0.y + c1.x;
        mirror_out[m] = c0.x + c1.y;
        mirror_out[m + 1] = c1.x - c0.y;
      };
      join_column(0, 0);
      for (int i = 1; i < size; ++i) join_column(2 * i, 2 * (size - i));
    }
  }

  void pick(std::size_t index, float const* values, WindowCorrelation& result) const {
    int const column = static_cast<int>(index % static_cast<std::size_t>(grid_.columns));
    int const row = static_cast<int>(index / static_cast<std::size_t>(grid_.columns));
    PlaneView<float> const plane{values, x_.size(), 2};
    PeakList<float> const found = find_peaks(plane, radius_);
    if (found.count == 0) {
      result.outcome = WindowCorrelation::Outcome::no_signal;
      return;
    }
    result.outcome = WindowCorrelation::Outcome::measured;
    result.peaks = found.count;
    for (int p = 0; p < found.count; ++p) {
      PlanePeak<float> const& peak = found.peak[p];
      auto const along_x = [&](int d) { return plane(peak.x + d, peak.y) / x_.autocorrelation(column, peak.x + d); };
      auto const along_y = [&](int d) { return plane(peak.x, peak.y + d) / y_.autocorrelation(row, peak.y + d); };
      result.shift[p] = {peak.x + gaussian_peak_offset(along_x(-1), along_x(0), along_x(1)),
                         peak.y + gaussian_peak_offset(along_y(-1), along_y(0), along_y(1))};
    }
    double const second = found.count > 1 ? found.peak[1].height : 0.0;
    result.peak_ratio = std::min(largest_peak_ratio, found.peak[0].height / std::max(second, 1e-12));
  }

  ImagePair const& pair_;
  InterrogationGrid const& grid_;
  AxisWeights const& x_;
  AxisWeights const& y_;
  KnownTiles const& tiles_;
  int radius_;
  std::unique_ptr<FourierPlan> plan_;
  std::vector<std::complex<float>> window_;
  std::vector<std::complex<float>> spectrum_[2];
};

}  // namespace

std::vector<WindowCorrelation> correlate_windows(ImagePair const& pair, InterrogationGrid const& grid,
                                                 WindowWeighting weighting, int search_radius_px,
                                                 std::string const& label) {
  GLADSTONE_EXPECTS(search_radius_px > 0 && 2 * search_radius_px <= grid.window_px && grid.window_px % 2 == 0);
  AxisWeights const x(grid, grid.columns, pair.columns, weighting);
  AxisWeights const y(grid, grid.rows, pair.rows, weighting);
  KnownTiles const tiles(pair);
  std::vector<WindowCorrelation> results(grid.size());
  Progress progress(label, grid.size());
  parallel_chunks(grid.size(), windows_per_chunk, [&](std::size_t begin, std::size_t end) {
    PairwiseCorrelation correlation(pair, grid, x, y, tiles, search_radius_px);
    correlation(begin, end, results);
    progress.advance(end - begin);
  });
  return results;
}

}  // namespace gladstone
