#pragma once

#include <cstddef>
#include <vector>

#include "render/base/host_device.h"
#include "render/base/vec.h"
#include "render/sensor/error_function.h"

namespace gladstone::inline sensor {

/// Size of the diffraction-limited PSF of a circular pupil in incoherent light, in multiples of N (1 + M) lambda
/// (Adrian & Yao 1985; Raffel et al. 2018, section 2). Eq. 8 of Rajendran et al. (2019) has a superfluous factor pi.
struct SpotSize {
  double scale;  ///< N (1 + M) lambda [m]

  /// Diameter of the Airy pattern's first dark ring [m].
  double first_zero_diameter() const { return 2.43934 * scale; }
  /// Standard deviation of the Gaussian fitted to the Airy pattern within its first zero [m].
  double matched_sigma() const { return 0.4206042622 * scale; }
};

/// Square of pixels that the PSF of one ray covers: columns [column, column + width), rows likewise.
struct Footprint {
  int column;
  int row;
  int width;
};

/// Gaussian PSF integrated over pixels by the error function. The weights of a footprint are the product of one factor
/// per column and one per row; they sum to one up to erfc(reach / (sqrt 2 sigma)).
template <class T>
struct GaussianSpot {
  T sigma{};  ///< standard deviation [px]

  static constexpr int most_width = 64;

  /// Number of pixels on each side of the middle one. A footprint ends at least 5.5 standard deviations from the centre
  /// of the PSF, which is at most half a pixel from the middle of its pixel: 4e-8 of the light lies beyond.
  GLADSTONE_HD int half_width() const { return static_cast<int>(T(5.5) * sigma + T(1)); }

  GLADSTONE_HD Footprint footprint(Vec2<T> p) const {
    using std::floor;
    int const half = half_width();
    return {static_cast<int>(floor(p.x + T(0.5))) - half, static_cast<int>(floor(p.y + T(0.5))) - half, 2 * half + 1};
  }
  /// Computes the fractions of light that fall on the `width` pixels from `first` on, along one axis, for a PSF centred
  /// at p [px].
  GLADSTONE_HD void shares(T p, int first, int width, T* out) const {
    constexpr T offset[8] = {T(-0.5), T(0.5), T(1.5), T(2.5), T(3.5), T(4.5), T(5.5), T(6.5)};
    constexpr int rows = 3, edges = 4 * rows;
    using Four = Lanes<T, 4>;
    Four const scale = Four::all(T(1) / sigma);
    T integral[edges + 1];  // integral at the preceding edge, then at the edges evaluated together
    // Evaluate twelve pixel edges at a time; pixel i is bounded by edges i and i + 1.
    for (int edge = 0; edge <= width; edge += edges) {
      Four value[rows];
      for (int row = 0; row < rows; ++row) {
        int const here = edge + 4 * row, group = here - here % 8;
        value[row] = (Four::all(T(first + group) - p) + Four::load(offset + here % 8)) * scale;
      }
      edge_values(value);
      if (edge > 0) integral[0] = integral[edges];
      for (int i = 0; i < edges; ++i) integral[i + 1] = value[i / 4].lane(i % 4);
      int const begin = edge > 0 ? 0 : 1, end = width - edge < edges ? width - edge : edges - 1;
      for (int i = begin; i <= end; ++i) out[edge + i - 1] = integral[i + 1] - integral[i];
    }
  }
  /// Computes the shares and their Taylor coefficients with respect to p, up to the given order: the derivative of
  /// order k over k!.
  /// @param out  [order + 1][width]
  GLADSTONE_HD void taylor_shares(T p, int first, int width, int order, T* out) const {
    shares(p, first, width, out);
    T const per_sigma = T(1) / sigma;
    for (int edge = 0; edge <= width; ++edge) {
      EdgeTerms const terms((T(first + edge) - T(0.5) - p) * per_sigma, per_sigma);
      for (int k = 1; k <= order; ++k) {
        T const here = terms.of[k];
        if (edge < width) out[k * width + edge] = -here;
        if (edge > 0) out[k * width + edge - 1] += here;
      }
    }
  }

  /// Replaces the position t of each pixel edge, in standard deviations from the centre of the PSF, by the integral of
  /// the normal distribution from the centre to the edge. A pixel's share is the difference between its two edges.
  template <int N, int K>
  [[gnu::always_inline]] GLADSTONE_HD static void edge_values(Lanes<T, N> (&t)[K]) {
    for (auto& row : t) row = row * Lanes<T, N>::all(T(0.70710678118654752440));
    error_function(t);
    for (auto& row : t) row = row * Lanes<T, N>::all(T(0.5));
  }
  GLADSTONE_HD static T edge_value(T t) {
    Lanes<T, 1> alone[1] = {{{t}}};
    edge_values(alone);
    return alone[0].lane(0);
  }

  /// Taylor coefficients of the normal distribution's integral up to an edge, with respect to the position of its
  /// centre, from Hermite polynomials (Abramowitz & Stegun 26.2.31).
  /// @param t          distance of the edge from the centre, in standard deviations [1]
  /// @param per_sigma  reciprocal of the standard deviation [1/px]
  struct EdgeTerms {
    T of[5];
    GLADSTONE_HD EdgeTerms(T t, T per_sigma) {
      using std::exp;
      of[0] = T(0);
      of[1] = T(-0.39894228040143267794) * exp(T(-0.5) * t * t) * per_sigma;
      of[2] = of[1] * t * per_sigma * T(1.0 / 2);
      of[3] = of[1] * (t * t - T(1)) * per_sigma * per_sigma * T(1.0 / 6);
      of[4] = of[1] * (t * t - T(3)) * t * per_sigma * per_sigma * per_sigma * T(1.0 / 24);
    }
  };
};

/// Airy pattern integrated over pixels and tabulated over sub-pixel positions. The pattern is cut at the larger of
/// 6 N (1 + M) lambda, which contains 97 % of the light, and three pixels, and renormalised to one. Linear
/// interpolation between positions has an error of about 1e-4 of the peak.
class AiryTable {
 public:
  struct View {
    double const* shares = nullptr;  ///< shares of the pixels, [sub_y][sub_x][row][column]
    int subdivisions = 0;            ///< table steps per pixel; subdivisions + 1 positions per axis
    int half_width = 0;              ///< half width of the footprint, without its middle pixel [px]

    /// Number of elements of `shares`.
    std::size_t count() const {
      auto const positions = static_cast<std::size_t>(subdivisions + 1),
                 width = static_cast<std::size_t>(2 * half_width + 1);
      return positions * positions * width * width;
    }
    /// Returns the share of pixel (column, row) of the footprint; the PSF is centred at (x, y), each within [-0.5, 0.5]
    /// px of the middle pixel's centre.
    GLADSTONE_HD double share(double x, double y, int row, int column) const {
      double const u = (x + 0.5) * subdivisions, v = (y + 0.5) * subdivisions;
      int const iu = static_cast<int>(u) < subdivisions ? static_cast<int>(u) : subdivisions - 1;
      int const iv = static_cast<int>(v) < subdivisions ? static_cast<int>(v) : subdivisions - 1;
      double const fu = u - iu, fv = v - iv;
      long long const width = 2 * half_width + 1, footprint = width * width;
      double const* const lower =
          shares + (static_cast<long long>(iv) * (subdivisions + 1) + iu) * footprint + row * width + column;
      double const* const upper = lower + (subdivisions + 1) * footprint;
      double const low = lower[0] + fu * (lower[footprint] - lower[0]);
      double const high = upper[0] + fu * (upper[footprint] - upper[0]);
      return low + fv * (high - low);
    }
  };

  /// @param scale_px  N (1 + M) lambda: f-number N, magnification M, wavelength lambda [px]
  explicit AiryTable(double scale_px);
  View view() const { return {shares_.data(), subdivisions_, half_width_}; }

 private:
  int subdivisions_;
  int half_width_;
  std::vector<double> shares_;
};

}  // namespace gladstone::inline sensor
