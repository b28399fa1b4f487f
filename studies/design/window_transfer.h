#pragma once

#include <cmath>
#include <vector>

#include "analysis/correlation/window_ops.h"
#include "render/base/units.h"

namespace gladstone {

/// What an interrogation window leaves of a wave of displacement across it, by its weights: correlation multiplies two
/// images of weight W each, so that a pixel counts by W^2, and a wave along an axis keeps the share
/// sum W^2(x) cos(2 pi x / wavelength) / sum W^2(x), over the pixels' places x from the middle. With equal weights that
/// is sin(a)/a, a = pi width / wavelength, up to the pixels' finite number (Scarano & Riethmuller, Exp. Fluids 26
/// (1999) 513). It holds for one pass; passes that deform the images give some of the rest back.
class WindowTransfer {
 public:
  WindowTransfer() = default;
  /// @param window_px nominal size; even
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
  /// Share of the pixels to one side, the i-th i + 1/2 px from the middle; they and those of the other side sum to 2.
  std::vector<double> const& side() const { return weights_; }

  /// Share of the amplitude. @param cycles_per_px pixels over the wavelength on the sensor
  template <class T>
  T share(T cycles_per_px) const {
    using std::cos;
    T const turn = 2 * pi * cycles_per_px;
    T sum(0);
    for (std::size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * cos((static_cast<double>(i) + 0.5) * turn);
    return sum;
  }

  /// Mean square distance of what counts from the middle [px^2]: share = 1 - (2 pi cycles)^2 / 2 times it for long
  /// waves.
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
  std::vector<double> weights_;  ///< of the pixels to one side; their sum is 1
};

}  // namespace gladstone
