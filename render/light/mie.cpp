#include "render/light/mie.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/contracts.h"

namespace gladstone::inline light {
namespace {

using Complex = std::complex<double>;

/// Computes the logarithmic derivatives D_n = psi_n'/psi_n at z for n = 0 to `terms`, by the downward recurrence
/// D_(n-1) = n/z - 1/(D_n + n/z) (Bohren & Huffman eq. 4.89). The arbitrary start value has no effect once psi_n has
/// dropped to 1e-8 of its magnitude at n = |z|, which happens 7 |z|^(1/3) orders above |z|.
template <class T>
std::vector<T> logarithmic_derivatives(T z, int terms) {
  double const size = std::abs(z);
  int const start = std::max(terms, static_cast<int>(size)) + 16 + static_cast<int>(8 * std::cbrt(size));
  std::vector<T> derivatives(static_cast<std::size_t>(terms) + 1);
  T const inverse = T(1) / z;
  T derivative(0);
  for (int n = start; n > 0; --n) {
    T const order = double(n) * inverse;
    derivative = order - T(1) / (derivative + order);
    if (n <= terms + 1) derivatives[static_cast<std::size_t>(n) - 1] = derivative;
  }
  return derivatives;
}

/// Number of angles that are evaluated together, for SIMD.
constexpr int angles_at_once = 8;

}  // namespace

int mie_terms(double x) {
  double const above = (x > 8 && x < 4200 ? 4.05 : 4.0) * std::cbrt(x) + (x > 8 ? 2 : 1);
  return static_cast<int>(std::ceil(x + above)) + 3;
}

MieCoefficients::MieCoefficients(double x, std::complex<double> m) : x_(x) {
  GLADSTONE_EXPECTS(x >= least_size_parameter && x <= largest_size_parameter);
  GLADSTONE_EXPECTS(m.real() > 0 && m.imag() >= 0);
  auto const terms = static_cast<std::size_t>(mie_terms(x));
  a_.resize(terms);
  b_.resize(terms);
  sum_.resize(terms);
  difference_.resize(terms);
  if (m == 1.0) return;
  auto const inside = logarithmic_derivatives(m * x, static_cast<int>(terms));
  auto const outside = logarithmic_derivatives(x, static_cast<int>(terms));

  // upward recurrence of psi_n and chi_n from psi_0 = sin x and chi_0 = cos x
  double psi_before = std::sin(x), chi_before = std::cos(x);
  double chi_before_that = -psi_before;
  double psi_before_that = chi_before;
  for (std::size_t i = 0; i < terms; ++i) {
    double const n = static_cast<double>(i) + 1;
    double const chi = (2 * n - 1) / x * chi_before - chi_before_that;
    // for n > x, upward recurrence of psi_n loses digits; D_n is accurate, so psi_n follows from psi_(n-1) and D_n
    bool const falls = n > x;
    double const psi = falls ? psi_before / (outside[i + 1] + n / x) : (2 * n - 1) / x * psi_before - psi_before_that;
    Complex const d = inside[i + 1];
    // numerators: psi_n (D_n / m) - psi_n', psi_n (m D_n) - psi_n'
    double const slope = psi_before - n * psi / x;
    Complex const electric = falls ? psi * (d / m - outside[i + 1]) : d / m * psi - slope;
    Complex const magnetic = falls ? psi * (m * d - outside[i + 1]) : m * d * psi - slope;
    // xi_n = psi_n - i chi_n
    double const chi_slope = chi_before - n * chi / x;
    a_[i] = electric / (electric - Complex(0, 1) * (d / m * chi - chi_slope));
    b_[i] = magnetic / (magnetic - Complex(0, 1) * (m * d * chi - chi_slope));
    double const weight = (2 * n + 1) / (n * (n + 1)) / 2;
    sum_[i] = weight * (a_[i] + b_[i]);
    difference_[i] = weight * (a_[i] - b_[i]);
    psi_before_that = psi_before;
    psi_before = psi;
    chi_before_that = chi_before;
    chi_before = chi;
  }
}

MieEfficiencies MieCoefficients::efficiencies() const {
  double extinction = 0, scattering = 0, asymmetry = 0;
  Complex back = 0;
  for (std::size_t i = a_.size(); i-- > 0;) {  // smallest terms first, to reduce rounding
    double const n = static_cast<double>(i) + 1;
    extinction += (2 * n + 1) * (a_[i] + b_[i]).real();
    scattering += (2 * n + 1) * (std::norm(a_[i]) + std::norm(b_[i]));
    back += (i % 2 == 0 ? -1.0 : 1.0) * (2 * n + 1) * (a_[i] - b_[i]);
    asymmetry += (2 * n + 1) / (n * (n + 1)) * (a_[i] * std::conj(b_[i])).real();
    if (i + 1 < a_.size()) {
      asymmetry += n * (n + 2) / (n + 1) * (a_[i] * std::conj(a_[i + 1]) + b_[i] * std::conj(b_[i + 1])).real();
    }
  }
  double const x2 = x_ * x_;
  return {2 / x2 * extinction, 2 / x2 * scattering, std::norm(back) / x2,
          scattering > 0 ? 2 * asymmetry / scattering : 0};
}

MieAmplitudes MieCoefficients::amplitudes(double angle) const {
  MieAmplitudes result;
  amplitudes(&angle, 1, &result);
  return result;
}

void MieCoefficients::amplitudes(double const* angle, std::size_t count, MieAmplitudes* result) const {
  // S1 + S2 is the sum of (a_n + b_n) (pi_n + tau_n), S1 - S2 that of (a_n - b_n) (pi_n - tau_n) (Wiscombe 1980)
  using Several = std::array<double, angles_at_once>;
  for (std::size_t first = 0; first < count; first += angles_at_once) {
    std::size_t const some = std::min<std::size_t>(angles_at_once, count - first);
    Several cosine{}, pi_n, pi_before{}, plus_re{}, plus_im{}, minus_re{}, minus_im{};
    for (std::size_t k = 0; k < some; ++k) cosine[k] = std::cos(angle[first + k]);
    pi_n.fill(1);
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      double const n = static_cast<double>(i) + 1;
      double const sum_re = sum_[i].real(), sum_im = sum_[i].imag();
      double const difference_re = difference_[i].real(), difference_im = difference_[i].imag();
      double const grow = (2 * n + 1) / n, fall = (n + 1) / n;
      for (std::size_t k = 0; k < angles_at_once; ++k) {
        // Bohren & Huffman eq. 4.47
        double const tau = n * cosine[k] * pi_n[k] - (n + 1) * pi_before[k];
        double const plus = pi_n[k] + tau, minus = pi_n[k] - tau;
        plus_re[k] += sum_re * plus;
        plus_im[k] += sum_im * plus;
        minus_re[k] += difference_re * minus;
        minus_im[k] += difference_im * minus;
        double const next = grow * cosine[k] * pi_n[k] - fall * pi_before[k];
        pi_before[k] = pi_n[k];
        pi_n[k] = next;
      }
    }
    for (std::size_t k = 0; k < some; ++k) {
      Complex const plus(plus_re[k], plus_im[k]), minus(minus_re[k], minus_im[k]);
      result[first + k] = {plus + minus, plus - minus};
    }
  }
}

}  // namespace gladstone::inline light
