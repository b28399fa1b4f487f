#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace gladstone::inline light {

/// Range of size parameters x = pi d n / lambda for which the series is valid.
inline constexpr double least_size_parameter = 1e-6, largest_size_parameter = 1e5;

/// Efficiency factors of a sphere: cross-sections in a plane wave over the geometric cross-section pi d^2 / 4 [1].
struct MieEfficiencies {
  double q_ext = 0;   ///< extinction
  double q_sca = 0;   ///< scattering
  double q_back = 0;  ///< backscattering, 4 |S(180 deg)|^2 / x^2
  double g = 0;       ///< mean cosine of the scattering angle
};

/// Scattering amplitudes of a sphere at one angle (Bohren & Huffman 1983, eq. 4.74) [1]: S1 for the electric field
/// perpendicular to the scattering plane, S2 for the field parallel to it.
struct MieAmplitudes {
  std::complex<double> s1, s2;
  /// Returns (|S1|^2 + |S2|^2) / 2, for unpolarised light.
  double s11() const { return (std::norm(s1) + std::norm(s2)) / 2; }
};

/// Expansion coefficients a_n, b_n of the field scattered by a homogeneous sphere in a plane wave.
/// Bohren & Huffman, Absorption and Scattering of Light by Small Particles (1983), eq. 4.88 and appendix A: downward
/// recurrence of the logarithmic derivative of psi_n, with Wiscombe's number of terms (Appl. Opt. 19 (1980) 1505). The
/// time factor is exp(-i omega t), so that an absorbing sphere has m = n + i k with k >= 0.
/// Unlike in appendix A, psi_n for n > x is computed from the ratio psi_n / psi_(n-1), and the downward recurrence
/// starts 8 |m x|^(1/3) orders above |m x|; both preserve the last digits for the smallest and the largest spheres.
class MieCoefficients {
 public:
  /// @param x  size parameter pi d n / lambda, n the index of the surrounding medium, lambda the vacuum wavelength [1]
  /// @param m  refractive index of the sphere relative to the surrounding medium, n + i k [1]; m = 1 scatters no light
  /// @pre least_size_parameter <= x <= largest_size_parameter; real part of m > 0, imaginary part >= 0
  MieCoefficients(double x, std::complex<double> m);

  /// Coefficients a_n and b_n, n = 1, 2, ..., stored at index n - 1.
  std::vector<std::complex<double>> const& a() const { return a_; }
  std::vector<std::complex<double>> const& b() const { return b_; }

  /// Returns the efficiency factors (Bohren & Huffman eq. 4.61, 4.62, sec. 4.4.3 and p. 120). g is 0 if no light is
  /// scattered.
  MieEfficiencies efficiencies() const;

  /// Returns S1 and S2 at a scattering angle [rad]; 0 is forward.
  MieAmplitudes amplitudes(double angle) const;
  /// Computes S1 and S2 at `count` scattering angles [rad], several at a time.
  void amplitudes(double const* angle, std::size_t count, MieAmplitudes* result) const;

 private:
  double x_;
  std::vector<std::complex<double>> a_, b_;
  std::vector<std::complex<double>> sum_, difference_;  ///< (2n+1)/(n(n+1)) (a_n +- b_n) / 2
};

/// Returns the number of terms of the series for a size parameter x: Wiscombe's (Appl. Opt. 19 (1980) 1505) plus three,
/// which reduces the relative error from 1e-10 to rounding.
int mie_terms(double x);

}  // namespace gladstone::inline light
