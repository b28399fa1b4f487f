#pragma once

#include "render/base/host_device.h"

/// Fourier transforms of four or eight values, roots of unity to join them by, and what two real lines transformed as
/// one come to.
namespace gladstone::cuda {

struct alignas(8) Complex {
  float re;
  float im;
};

GLADSTONE_HD constexpr Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
GLADSTONE_HD constexpr Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
GLADSTONE_HD constexpr Complex operator*(Complex a, Complex b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
GLADSTONE_HD constexpr Complex conj(Complex a) { return {a.re, -a.im}; }

/// cos(2 pi k / 64)
GLADSTONE_HD constexpr float cosine_64(int k) {
  k &= 63;
  float const sign = k > 16 && k < 48 ? -1.0f : 1.0f;
  int const half = k > 32 ? 64 - k : k;
  switch (half > 16 ? 32 - half : half) {
    case 0:
      return sign;
    case 1:
      return sign * 0.99518472667219693f;
    case 2:
      return sign * 0.98078528040323043f;
    case 3:
      return sign * 0.95694033573220882f;
    case 4:
      return sign * 0.92387953251128674f;
    case 5:
      return sign * 0.88192126434835502f;
    case 6:
      return sign * 0.83146961230254524f;
    case 7:
      return sign * 0.77301045336273699f;
    case 8:
      return sign * 0.70710678118654752f;
    case 9:
      return sign * 0.63439328416364549f;
    case 10:
      return sign * 0.55557023301960222f;
    case 11:
      return sign * 0.47139673682599764f;
    case 12:
      return sign * 0.38268343236508977f;
    case 13:
      return sign * 0.29028467725446233f;
    case 14:
      return sign * 0.19509032201612825f;
    case 15:
      return sign * 0.09801714032956060f;
    default:
      return 0.0f;
  }
}

/// exp(sign 2 pi i k / size), size 32 or 64.
template <int size, int sign>
GLADSTONE_HD constexpr Complex unit_root(int k) {
  int const m = k * (64 / size);
  return {cosine_64(m), sign * cosine_64(m - 16)};
}

/// a times sign i.
template <int sign>
GLADSTONE_HD constexpr Complex quarter_turn(Complex a) {
  return sign > 0 ? Complex{-a.im, a.re} : Complex{a.im, -a.re};
}

/// Transform of z[0], z[stride], .. in place and in natural order.
template <int radix, int sign, int stride>
GLADSTONE_HD void small_transform(Complex* z) {
  static_assert(radix == 4 || radix == 8);
  if constexpr (radix == 4) {
    Complex const a = z[0] + z[2 * stride], b = z[0] - z[2 * stride];
    Complex const c = z[stride] + z[3 * stride], d = quarter_turn<sign>(z[stride] - z[3 * stride]);
    z[0] = a + c;
    z[stride] = b + d;
    z[2 * stride] = a - c;
    z[3 * stride] = b - d;
  } else {
    Complex even[4] = {z[0], z[2 * stride], z[4 * stride], z[6 * stride]};
    Complex odd[4] = {z[stride], z[3 * stride], z[5 * stride], z[7 * stride]};
    small_transform<4, sign, 1>(even);
    small_transform<4, sign, 1>(odd);
    constexpr float c = 0.70710678118654752f;
    // an eighth of a turn is c (o + sign i o): joined with the sum
    Complex const u = odd[1] + quarter_turn<sign>(odd[1]), v = quarter_turn<sign>(odd[3]) - odd[3];
    Complex const w = quarter_turn<sign>(odd[2]);
    z[0] = even[0] + odd[0];
    z[4 * stride] = even[0] - odd[0];
    z[stride] = {even[1].re + c * u.re, even[1].im + c * u.im};
    z[5 * stride] = {even[1].re - c * u.re, even[1].im - c * u.im};
    z[2 * stride] = even[2] + w;
    z[6 * stride] = even[2] - w;
    z[3 * stride] = {even[3].re + c * v.re, even[3].im + c * v.im};
    z[7 * stride] = {even[3].re - c * v.re, even[3].im - c * v.im};
  }
}

/// Wave number k of two rows of a cross spectrum C = conj(A) B at once, both of real lines: rows 0 and n/2 of a plane
/// of n rows. With P = A_0 + i A_n/2 and R likewise of b, C_0 + i C_n/2 at k; M and S are P and R at -k.
GLADSTONE_HD constexpr Complex packed_product(Complex p, Complex m, Complex r, Complex s) {
  Complex const first = (conj(p) + m) * (r + conj(s));
  Complex const second = (conj(p) - m) * (r - conj(s));
  return {0.25f * (first.re - second.im), 0.25f * (first.im + second.re)};
}

}  // namespace gladstone::cuda
