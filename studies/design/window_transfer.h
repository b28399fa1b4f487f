#pragma once

#include <cmath>
#include <vector>

#include "analysis/correlation/window_ops.h"
#include "render/base/units.h"

namespace gladstone::inline design {

/// Amplitude transfer of an interrogation window for a displacement wave along one axis. Correlation multiplies two
/// images weighted by W, so pixels have the weight W^2, and the transfer is sum W^2(x) cos(2 pi x / wavelength) / sum
/// W^2(x) over the pixel positions x relative to the centre. For equal weights it approaches sin(a)/a, a = pi width /
/// wavelength (Scarano & Riethmuller, Exp. Fluids 26 (1999) 513). Valid for one pass; passes that deform the images
/// recover part of the loss.
class WindowTransfer {
 public:
  WindowTransfer() = default;
  /// @param window_px  nominal size, even [px]
  WindowTransfer(WindowWeighting weighting, int window_px) : window_px_(window_px) {
    double sum = 0;
    for (double place = 0.5; place < window_half_support(weighting, static_cast<double>(window_px)); ++place) {
      double const weight = axis_weight(weighting, place, static_cast<double>(window_px));
      weights_.push_back(weight * weight);
      sum += weight * weight;
    }
    for (double& weight : weights_) weight /= sum;
  }

  int window_px() const { return window_px_; }
  /// Returns the weights of the pixels on one side of the centre, the i-th at i + 1/2 px from it; their sum is 1.
  std::vector<double> const& side() const { return weights_; }

  /// Returns the amplitude transfer [1].
  /// @param cycles_per_px  reciprocal of the wavelength on the sensor [1/px]
  template <class T>
  T share(T cycles_per_px) const {
    using std::cos;
    T const turn = 2 * pi * cycles_per_px;
    T sum(0);
    for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * cos((static_cast<double>(i) + 0.5) * turn);
    return sum;
  }

  /// Returns the mean square distance from the centre by weight [px^2]; for long waves, the transfer is 1 - (2 pi
  /// cycles)^2 / 2 times it.
  double variance() const {
    double sum = 0;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      double const place = static_cast<double>(i) + 0.5;
      sum += weights_[i] * place * place;
    }
    return sum;
  }

 private:
  int window_px_ = 0;
  std::vector<double> weights_;  ///< weights of the pixels on one side; their sum is 1
};

}  // namespace gladstone::inline design
