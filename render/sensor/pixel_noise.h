#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "render/base/random.h"

/// Noise of a pixel as quantiles of uniform random numbers, for host and device. A quantile takes one random number.
/// Functions without branches, loops of fixed length apart, are vectorised by the compiler for blocks of pixels.
namespace gladstone::inline sensor {

/// Returns the IEEE 754 representation of a number.
GLADSTONE_HD inline std::uint64_t bits_of(double value) {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

/// Returns the number with an IEEE 754 representation.
GLADSTONE_HD inline double from_bits(std::uint64_t bits) {
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

/// Random numbers of the pixels of a frame: two terms of the SplitMix64 sequence (Steele, Lea & Flood 2014) for each,
/// at a start that depends on seed and stream. Computes any of them by a single mixing function.
class FrameNoise {
 public:
  static constexpr std::uint64_t increment = 0x9e3779b97f4a7c15ULL;

  GLADSTONE_HD FrameNoise(std::uint64_t seed, RandomStream stream) : start_(random_bits(seed, stream, 0)) {}
  /// Returns the random bits of a pixel's shot noise, and of its read noise.
  GLADSTONE_HD std::uint64_t shot(std::uint64_t pixel) const { return mix64(state(pixel)); }
  GLADSTONE_HD std::uint64_t read(std::uint64_t pixel) const { return mix64(state(pixel) + increment); }
  /// Returns the number from which shot(pixel) is mixed. The number for read(pixel) is larger by one increment, and the
  /// number for shot() of the next pixel by two.
  GLADSTONE_HD std::uint64_t state(std::uint64_t pixel) const { return start_ + (2 * pixel + 1) * increment; }

 private:
  std::uint64_t start_;
};

/// Converts random bits to a uniform number in (0, 1), both ends excluded: the first 52 bits, plus one half, times
/// 2^-52. Computed without rounding as a number from 1 to 2, minus one.
GLADSTONE_HD inline double to_open_unit(std::uint64_t bits) {
  return from_bits(bits >> 12 | 0x3ff0000000000000ULL) - (1 - 0x1p-53);
}

/// Evaluates a polynomial by Horner's scheme. @param coefficient  coefficients, the constant term first
template <int Count>
GLADSTONE_HD inline double evaluate_polynomial(double const (&coefficient)[Count], double x) {
  double value = coefficient[Count - 1];
  for (int k = Count - 2; k >= 0; --k) value = value * x + coefficient[k];
  return value;
}

/// Natural logarithm without branches: exponent times ln 2, plus the logarithm of a mantissa from 0.71 to 1.42, by a
/// polynomial whose relative error is 4e-9 (minimax of ln(1 + f) / f).
/// @pre t is a positive normal number
GLADSTONE_HD inline double fast_logarithm(double t) {
  constexpr double series[] = {0.999999999959,  -0.499999882897, 0.333333260042,  -0.250015865642, 0.200019679388,
                               -0.166090121357, 0.141818447375,  -0.132434762317, 0.12904608148,   -0.0762101862067};
  constexpr std::uint64_t root_half = 0x3fe6a09e667f3bcdULL, bias = 1024, two_52 = 0x4330000000000000ULL;
  std::uint64_t const bits = bits_of(t), exponent = (bits - root_half + (bias << 52)) >> 52;
  double const power = from_bits(exponent | two_52) - (0x1p52 + static_cast<double>(bias));
  double const f = from_bits(bits - (exponent << 52) + (bias << 52)) - 1;
  return power * 0.69314718055994530942 + f * evaluate_polynomial(series, f);
}

/// Standard normal quantile. The relative error is 1e-7.
struct NormalQuantile {
  /// Returns true in the central part of the distribution, which ends where 4 u (1 - u) is exp(-6.25) and contains all
  /// but 0.1 % of the probability.
  GLADSTONE_HD static bool is_central(double u) {
    double const x = 2 * u - 1;
    return 1 - x * x >= 0.00193045413622771;
  }
  /// Returns the quantile in the central part: x = 2 u - 1 times a polynomial of -ln(1 - x^2) (Giles, GPU Computing
  /// Gems Jade Edition (2011) 109), here the minimax polynomial for -ln(1 - x^2) up to 6.25. @pre is_central(u);
  /// otherwise finite, but inaccurate
  GLADSTONE_HD static double central(double u) {
    constexpr double series[] = {1.2533140442,       0.328120019652,    0.0163162573982,    -0.00326817411208,
                                 -0.000213936492645, 8.20877731452e-05, -6.60807000049e-07, -1.59112339415e-06,
                                 1.88914301111e-07,  -7.15582251397e-09};
    double const x = 2 * u - 1;
    return x * evaluate_polynomial(series, -fast_logarithm(1 - x * x));
  }
  /// Returns the quantile in a tail by the rational functions of Wichura, Appl. Stat. 37 (1988) 477, algorithm AS 241,
  /// PPND7.
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

/// Quantile of the Poisson distribution.
struct PoissonQuantile {
  /// Smallest mean for which the quantile is computed by expanded(), instead of adding up probabilities.
  static constexpr double least_expanded = 16;

  /// Returns the quantile by the first four terms of an expansion, rounded down (Giles, ACM Trans. Math. Softw. 42
  /// (2016) 7, algorithm 955, Eq. 6). The cumulative probabilities have an error below 2e-5 for a mean of 16, which
  /// decreases with the square of the mean.
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
  /// Number of probabilities that are added up at most; more electrons have a probability below 1e-60.
  static constexpr int most_terms = 120;

  /// Computes e^-mean as the 32nd power of the Taylor polynomial of e^-x, x = mean / 32 <= 1/2. The remainder, at most
  /// x^14 / 14!, and rounding cause a relative error below 1e-13. @pre 0 <= mean <= least_expanded
  GLADSTONE_HD static double probability_of_none(double mean) {
    double const x = mean / 32;
    double value = 1;
    for (int k = 13; k > 0; --k) value = 1 - x * (1.0 / k) * value;
    for (int k = 0; k < 5; ++k) value *= value;
    return value;
  }
  /// Returns the quantile by adding up the probabilities until they exceed u. @pre 0 <= mean < least_expanded
  GLADSTONE_HD static double summed(double mean, double u) {
    double share = probability_of_none(mean), sum = share;
    int k = 0;
    while (u >= sum && k < most_terms) {
      ++k;
      share *= mean * (1.0 / k);
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

}  // namespace gladstone::inline sensor
