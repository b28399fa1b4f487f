#pragma once

#include <cmath>

#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/subpixel_peak.h"
#include "render/base/host_device.h"

/// Fits of Gaussian peaks, for the CPU and the CUDA kernels.
namespace gladstone::inline correlation {

/// Implementation of fit_gauss3().
struct GaussAlongAxes {
  GLADSTONE_HD PeakFit operator()(PeakPatch const& patch) const {
    auto const& v = patch.value;
    PeakBetweenSamples<double> const across = gaussian_peak(v[1][0], v[1][1], v[1][2]);
    PeakBetweenSamples<double> const down = gaussian_peak(v[0][1], v[1][1], v[2][1]);
    return {across.offset, down.offset, across.log_rise + down.log_rise};
  }
};

/// Solves a x = b for a symmetric positive definite matrix by Cholesky decomposition (Eigen's is not available on
/// devices); x replaces b. Only the lower half of the matrix is read.
/// @return false if the matrix is not positive definite
template <int size>
GLADSTONE_HD bool solve_positive_definite(double (&a)[size][size], double (&b)[size]) {
  for (int k = 0; k < size; ++k) {
    for (int j = 0; j < k; ++j) a[k][k] -= a[k][j] * a[k][j];
    if (!(a[k][k] > 0.0)) return false;
    a[k][k] = std::sqrt(a[k][k]);
    for (int i = k + 1; i < size; ++i) {
      for (int j = 0; j < k; ++j) a[i][k] -= a[i][j] * a[k][j];
      a[i][k] /= a[k][k];
    }
    for (int j = 0; j < k; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  for (int k = size - 1; k >= 0; --k) {
    for (int i = k + 1; i < size; ++i) b[k] -= a[i][k] * b[i];
    b[k] /= a[k][k];
  }
  return true;
}

/// Implementation of fit_gauss2d().
struct GaussOfAnyAxes {
  GLADSTONE_HD PeakFit operator()(PeakPatch const& patch) const {
    constexpr int terms = 6;
    double normal[terms][terms] = {}, c[terms] = {};
    double const middle = patch.value[1][1];
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        double const value = patch.value[y + 1][x + 1] / middle;
        if (!(value > 0.0)) return GaussAlongAxes()(patch);
        double const term[terms] = {1.0, double(x), double(y), double(x * x), double(x * y), double(y * y)};
        double const weight = value * value, weighted_log = weight * std::log(value);
        for (int i = 0; i < terms; ++i) {
          for (int j = 0; j <= i; ++j) normal[i][j] += weight * term[i] * term[j];
          c[i] += weighted_log * term[i];
        }
      }
    if (!solve_positive_definite(normal, c)) return GaussAlongAxes()(patch);
    double const determinant = 4.0 * c[3] * c[5] - c[4] * c[4];
    if (!(c[3] < 0.0) || !(determinant > 0.0)) return GaussAlongAxes()(patch);
    double const x = (c[4] * c[2] - 2.0 * c[5] * c[1]) / determinant;
    double const y = (c[4] * c[1] - 2.0 * c[3] * c[2]) / determinant;
    if (!(std::abs(x) <= 1.0 && std::abs(y) <= 1.0)) return GaussAlongAxes()(patch);
    return {x, y, c[0] + 0.5 * (c[1] * x + c[2] * y)};
  }
};

}  // namespace gladstone::inline correlation
