#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace gladstone {

/// Sizes that the series is summed for: size parameter x = pi d n / lambda.
inline constexpr double least_size_parameter = 1e-6, largest_size_parameter = 1e5;

/// What a sphere takes out of a plane wave, over its cross-section pi d^2/4, and how it sends it on [1].
struct MieEfficiencies {
  double q_ext = 0;   ///< extinction
  double q_sca = 0;   ///< scattering
  double q_back = 0;  ///< backscattering, 4 |S(180 deg)|^2 / x^2
  double g = 0;       ///< mean cosine of the scattering angle
};

/// Amplitudes of the light that a sphere scatters into an angle (Bohren & Huffman 1983, eq. 4.74): a field across the
/// plane of scattering is sent on by S1, a field in it by S2 [1].
struct MieAmplitudes {
  std::complex<double> s1, s2;
  /// (|S1|^2 + |S2|^2) / 2, for light without polarisation.
  double s11() const { return (std::norm(s1) + std::norm(s2)) / 2; }
};

/// Coefficients a_n, b_n of the field that a homogeneous sphere scatters out of a plane wave.
/// Bohren & Huffman, Absorption and Scattering of Light by Small Particles (1983), eq. 4.88 and appendix A: the
/// logarithmic derivative of psi_n is recurred downward, and Wiscombe's number of terms (Appl. Opt. 19 (1980) 1505) is
/// summed. Time goes as exp(-i omega t), so that an absorbing sphere has m = n + i k with k >= 0.
/// Unlike there, psi_n beyond n = x is found from the ratio of its neighbours, and downward recurrence starts
/// 8 |m x|^(1/3) orders above |m x|: both keep the last digits of the smallest and of the largest spheres.
class MieCoefficients {
 public:
  /// @param x size parameter pi d n / lambda, n and lambda those of the surroundings and of vacuum [1]
  /// @param m index of the sphere over that of the surroundings, n + i k [1]; 1 gives no scattering at all
  /// @pre least_size_parameter <= x <= largest_size_parameter; real part of m > 0, imaginary part >= 0
  MieCoefficients(double x, std::complex<double> m);

  double size_parameter() const { return x_; }
  std::complex<double> relative_index() const { return m_; }
  /// a_n and b_n, n = 1, 2, ... at places 0, 1, ...
  std::vector<std::complex<double>> const& a() const { return a_; }
  std::vector<std::complex<double>> const& b() const { return b_; }

  /// Bohren & Huffman eq. 4.61, 4.62, sec. 4.4.3 and p. 120. Where nothing is scattered g is 0.
  MieEfficiencies efficiencies() const;

  /// S1 and S2 at a scattering angle; 0 is forward [rad].
  MieAmplitudes amplitudes(double angle) const;
  /// The same at `count` angles, several at a time.
  void amplitudes(double const* angle, std::size_t count, MieAmplitudes* result) const;

 private:
  double x_;
  std::complex<double> m_;
  std::vector<std::complex<double>> a_, b_;
  std::vector<std::complex<double>> sum_, difference_;  ///< (2n+1)/(n(n+1)) (a_n +- b_n) / 2
};

/// Number of terms of the series for a size parameter x: Wiscombe's (Appl. Opt. 19 (1980) 1505) and three more, which
/// take the relative error from 1e-10 to that of rounding.
int mie_terms(double x);

}  // namespace gladstone
