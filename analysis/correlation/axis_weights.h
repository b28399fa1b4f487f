#pragma once

#include <vector>

#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/host_device.h"

namespace gladstone::inline correlation {

/// Non-owning view of the weights of all windows of a grid along one axis, for host and device.
struct AxisWeightsView {
  int size;                        ///< side of a window's support, twice the nominal window [px]
  int first_px;                    ///< image position of the first pixel of the support of window 0
  int spacing_px;                  ///< distance between the supports of neighbouring windows [px]
  float const* weights;            ///< weights of the pixels [window][size], 0 outside the image
  double const* autocorrelations;  ///< autocorrelations of the weights [window][lags(size)]
  double const* sums;              ///< sum of the weights of each window

  GLADSTONE_HD static constexpr int lags(int size) { return size / 4 + 2; }
  GLADSTONE_HD int first(int window) const { return first_px + window * spacing_px; }
  GLADSTONE_HD float const* weight(int window) const { return weights + static_cast<long long>(window) * size; }
  GLADSTONE_HD double sum(int window) const { return sums[window]; }
  /// Returns the autocorrelation of a window's weights w at a lag, the sum of w(i) w(i + lag). @pre |lag| <= size/4 + 1
  GLADSTONE_HD double autocorrelation(int window, int lag) const {
    return autocorrelations[static_cast<long long>(window) * lags(size) + (lag < 0 ? -lag : lag)];
  }
  /// Returns the factor by which a correlation plane decreases with the shift: the autocorrelation of the weights
  /// relative to that at lag 0.
  GLADSTONE_HD double shift_attenuation(int window, int lag) const {
    return autocorrelation(window, lag) / autocorrelation(window, 0);
  }
};

/// Weights of the windows of a grid along one axis, cut off at the image border, and their autocorrelations.
class AxisWeights {
 public:
  /// @param image_length  size of the image along this axis [px]
  AxisWeights(InterrogationGrid const& grid, GridAxis axis, int image_length, WindowWeighting weighting)
      : size_(2 * grid.window_px), first_px_(grid.first_px(axis) - grid.window_px / 2), spacing_px_(grid.spacing_px) {
    int const windows = grid.windows(axis);
    int const lags = AxisWeightsView::lags(size_);
    weights_.reserve(static_cast<std::size_t>(windows) * size_);
    autocorrelations_.reserve(static_cast<std::size_t>(windows) * lags);
    // index of the first window that is not cut off at a border; all such windows have equal weights
    int whole_one = -1;
    for (int k = 0; k < windows; ++k) {
      int const first = first_px_ + k * spacing_px_;
      bool const whole = first >= 0 && first + size_ <= image_length;
      if (whole && whole_one >= 0) {
        repeat(whole_one, lags);
        continue;
      }
      if (whole) whole_one = k;
      for (int i = 0; i < size_; ++i) {
        bool const inside = first + i >= 0 && first + i < image_length;
        double const offset = i - 0.5 * (size_ - 1);
        double const weight = axis_weight(weighting, offset, static_cast<double>(grid.window_px));
        weights_.push_back(inside ? static_cast<float>(weight) : 0.0f);
      }
      float const* w = weights_.data() + static_cast<std::size_t>(k) * size_;
      double all = 0.0;
      for (int i = 0; i < size_; ++i) all += w[i];
      sums_.push_back(all);
      for (int lag = 0; lag < lags; ++lag) {
        double sum = 0.0;
        for (int i = 0; i + lag < size_; ++i) sum += static_cast<double>(w[i]) * w[i + lag];
        autocorrelations_.push_back(sum);
      }
    }
  }

  AxisWeightsView view() const {
    return {size_, first_px_, spacing_px_, weights_.data(), autocorrelations_.data(), sums_.data()};
  }
  std::vector<float> const& weights() const { return weights_; }
  std::vector<double> const& autocorrelations() const { return autocorrelations_; }
  std::vector<double> const& sums() const { return sums_; }

 private:
  void repeat(int window, int lags) {
    for (int i = 0; i < size_; ++i) weights_.push_back(weights_[static_cast<std::size_t>(window) * size_ + i]);
    for (int i = 0; i < lags; ++i)
      autocorrelations_.push_back(autocorrelations_[static_cast<std::size_t>(window) * lags + i]);
    sums_.push_back(sums_[static_cast<std::size_t>(window)]);
  }

  int size_;
  int first_px_;
  int spacing_px_;
  std::vector<float> weights_;
  std::vector<double> autocorrelations_;
  std::vector<double> sums_;
};

}  // namespace gladstone::inline correlation
