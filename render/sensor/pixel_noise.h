#pragma once

#include <cmath>

#include "render/base/random.h"

/// Noise of a pixel as quantiles of uniform random numbers, for host and device. A quantile takes one random number,
/// most often without logarithms or loops, and blocks of pixels are computed in SIMD registers.
namespace gladstone {

/// Random numbers of the pixels of a frame: two terms of the SplitMix64 sequence (Steele, Lea & Flood 2014) for each,
/// at a start that depends on seed and stream. Computes any of them by a single mixing function.
class FrameNoise {
 public:
  GLADSTONE_HD FrameNoise(std::uint64_t seed, RandomStream stream) : start_(random_bits(seed, stream, 0)) {}
  /// Returns the random bits of a pixel's shot noise, and of its read noise.
  GLADSTONE_HD std::uint64_t shot(std::uint64_t pixel) const { return term(2 * pixel); }
  GLADSTONE_HD std::uint64_t read(std::uint64_t pixel) const { return term(2 * pixel + 1); }

 private:
  GLADSTONE_HD std::uint64_t term(std::uint64_t index) const {
    return mix64(start_ + (index + 1) * 0x9e3779b97f4a7c15ULL);
  }
  std::uint64_t start_;
};

/// Converts random bits to a uniform number in (0, 1), both ends excluded, with 52 bits of precision.
GLADSTONE_HD constexpr double to_open_unit(std::uint64_t bits) {
  return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}

/// Standard normal quantile by rational functions (Wichura, Appl. Stat. 37 (1988) 477, algorithm AS 241, PPND7); the
/// relative error is 1e-7.
struct NormalQuantile {
  static constexpr double central_half_width = 0.425;

  GLADSTONE_HD static bool is_central(double u) {
    double const q = u - 0.5;
    return q <= central_half_width && q >= -central_half_width;
  }
  /// @pre is_central(u)
  GLADSTONE_HD static double central(double u) {
    double const q = u - 0.5, r = 0.180625 - q * q;
    return q * (((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179) /
           (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0);
  }
  /// @pre !is_central(u), 0 < u < 1
  GLADSTONE_HD static double tail(double u) {
    using std::log;
    using std::sqrt;
    double const r = sqrt(-log(u < 0.5 ? u : 1 - u));
    double value;
    if (r <= 5) {
      double const t = r - 1.6;
      value = (((0.17023821103 * t + 1.3067284816) * t + 2.7568153900) * t + 1.4234372777) /
              ((0.12021132975 * t + 0.73700164250) * t + 1.0);
    } else {
      double const t = r - 5;
      value = (((0.017337203997 * t + 0.42868294337) * t + 3.0812263860) * t + 6.6579051150) /
              ((0.012258202635 * t + 0.24197894225) * t + 1.0);
    }
    return u < 0.5 ? -value : value;
  }
  GLADSTONE_HD double operator()(double u) const { return is_central(u) ? central(u) : tail(u); }
};

/// Poisson quantile.
struct PoissonQuantile {
  /// Mean from which the expansion is used.
  static constexpr double least_expanded = 16;

  /// Rounds the first four terms of an expansion of the quantile down (Giles, ACM Trans. Math. Softw. 42 (2016) 7,
  /// algorithm 955, Eq. 6). The cumulative probabilities have an error below 2e-5 for a mean of 16, which decreases
  /// with the square of the mean.
  /// @param z  normal quantile of the probability  @pre mean >= least_expanded
  GLADSTONE_HD static double expanded(double mean, double z) {
    using std::floor;
    using std::sqrt;
    double const root = sqrt(mean), inverse = 1 / root, zz = z * z;
    double const third = z * (zz * (-1.0 / 72) - 1.0 / 36);
    double const fourth = (zz * (1.0 / 270) + 7.0 / 810) * zz - 8.0 / 405;
    double const k = floor(mean + root * z + (zz * (1.0 / 6) + 1.0 / 3) + (fourth * inverse + third) * inverse);
    return k > 0 ? k : 0;
  }
  /// Adds up the probabilities until they exceed u. @pre 0 <= mean < least_expanded
  GLADSTONE_HD static double summed(double mean, double u) {
    using std::exp;
    if (u < 1 - mean) return 0;   // P(0) = exp(-mean) >= 1 - mean
    constexpr double most = 120;  // reached with a probability below 1e-60
    double share = exp(-mean), sum = share, k = 0;
    while (u >= sum && k < most) {
      k += 1;
      share *= mean / k;
      sum += share;
    }
    return k;
  }
};

/// Returns the number of electrons of a mean charge [e]. @param u  uniform random number in (0, 1)
/// Every pixel saturates above 1e12 electrons, which have no noise.
GLADSTONE_HD inline double draw_electrons(double charge, double u) {
  if (!(charge > 0 && charge < 1e12)) return charge;
  return charge >= PoissonQuantile::least_expanded ? PoissonQuantile::expanded(charge, NormalQuantile{}(u))
                                                   : PoissonQuantile::summed(charge, u);
}

}  // namespace gladstone
