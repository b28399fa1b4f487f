#pragma once

#include "render/base/host_device.h"

/// Fourier transforms of two to sixteen values, roots of unity, and the cross spectrum of two real lines transformed as
/// one.
namespace gladstone::cuda::inline correlation {

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

/// Multiplies a by sign i.
template <int sign>
GLADSTONE_HD constexpr Complex quarter_turn(Complex a) {
  return sign > 0 ? Complex{-a.im, a.re} : Complex{a.im, -a.re};
}

/// exp(sign 2 pi i k / size), size 6, 12 or 16.
template <int size, int sign>
GLADSTONE_HD constexpr Complex small_root(int k) {
  if constexpr (size == 16) return unit_root<64, sign>(4 * k);
  constexpr float half_root_3 = 0.86602540378443865f;
  constexpr float cosine[12] = {1.0f,  half_root_3,  0.5f,  0.0f, -0.5f, -half_root_3,
                                -1.0f, -half_root_3, -0.5f, 0.0f, 0.5f,  half_root_3};
  int const m = k * (12 / size) % 12;
  return {cosine[m], sign * cosine[(m + 9) % 12]};
}

/// Transforms z[0], z[stride], .. in place, with the result in natural order.
template <int radix, int sign, int stride>
GLADSTONE_HD void small_transform(Complex* z) {
  static_assert(radix == 2 || radix == 3 || radix == 4 || radix == 5 || radix == 6 || radix == 8 || radix == 12 ||
                radix == 16);
  if constexpr (radix == 2) {
    Complex const a = z[0], b = z[stride];
    z[0] = a + b;
    z[stride] = a - b;
  } else if constexpr (radix == 3) {
    constexpr float sine = 0.86602540378443865f;
    Complex const sum = z[stride] + z[2 * stride], turned = quarter_turn<sign>(z[stride] - z[2 * stride]);
    Complex const mean{z[0].re - 0.5f * sum.re, z[0].im - 0.5f * sum.im};
    z[0] = z[0] + sum;
    z[stride] = {mean.re + sine * turned.re, mean.im + sine * turned.im};
    z[2 * stride] = {mean.re - sine * turned.re, mean.im - sine * turned.im};
  } else if constexpr (radix == 4) {
    Complex const a = z[0] + z[2 * stride], b = z[0] - z[2 * stride];
    Complex const c = z[stride] + z[3 * stride], d = quarter_turn<sign>(z[stride] - z[3 * stride]);
    z[0] = a + c;
    z[stride] = b + d;
    z[2 * stride] = a - c;
    z[3 * stride] = b - d;
  } else if constexpr (radix == 5) {
    constexpr float cosine_1 = 0.30901699437494742f, cosine_2 = -0.80901699437494742f;
    constexpr float sine_1 = 0.95105651629515357f, sine_2 = 0.58778525229247313f;
    Complex const near = z[stride] + z[4 * stride], far = z[2 * stride] + z[3 * stride];
    Complex const near_turned = quarter_turn<sign>(z[stride] - z[4 * stride]);
    Complex const far_turned = quarter_turn<sign>(z[2 * stride] - z[3 * stride]);
    auto const even = [&](float n, float f) {
      return Complex{z[0].re + n * near.re + f * far.re, z[0].im + n * near.im + f * far.im};
    };
    auto const odd = [&](float n, float f) {
      return Complex{n * near_turned.re + f * far_turned.re, n * near_turned.im + f * far_turned.im};
    };
    Complex const first = even(cosine_1, cosine_2), second = even(cosine_2, cosine_1);
    Complex const u = odd(sine_1, sine_2), v = odd(sine_2, -sine_1);
    z[0] = z[0] + near + far;
    z[stride] = first + u;
    z[4 * stride] = first - u;
    z[2 * stride] = second + v;
    z[3 * stride] = second - v;
  } else if constexpr (radix == 8) {
    Complex even[4] = {z[0], z[2 * stride], z[4 * stride], z[6 * stride]};
    Complex odd[4] = {z[stride], z[3 * stride], z[5 * stride], z[7 * stride]};
    small_transform<4, sign, 1>(even);
    small_transform<4, sign, 1>(odd);
    constexpr float c = 0.70710678118654752f;
    // The factor exp(sign 2 pi i / 8) is c (1 + sign i); c is applied together with the sum.
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
  } else {  // 6, 12 and 16: transforms of `outer` values, twiddle factors, transforms of `inner` values
    constexpr int outer = radix == 6 ? 2 : 4, inner = radix / outer;
    Complex natural[radix];
    for (int n = 0; n < inner; ++n) {
      small_transform<outer, sign, inner * stride>(z + n * stride);
      for (int k = 1; n > 0 && k < outer; ++k) {
        Complex& value = z[(inner * k + n) * stride];
        value = value * small_root<radix, sign>(n * k);
      }
    }
    for (int k = 0; k < outer; ++k) {
      small_transform<inner, sign, stride>(z + inner * k * stride);
      for (int n = 0; n < inner; ++n) natural[k + outer * n] = z[(inner * k + n) * stride];
    }
    for (int k = 0; k < radix; ++k) z[k * stride] = natural[k];
  }
}

/// Returns wave number k of rows 0 and n/2 of a cross spectrum C = conj(A) B with n rows, as C_0 + i C_n/2; the inverse
/// transforms of both rows along the columns are real. P = A_0 + i A_n/2 at k, and R likewise for b; M and S are P and
/// R at -k.
GLADSTONE_HD constexpr Complex packed_product(Complex p, Complex m, Complex r, Complex s) {
  Complex const first = (conj(p) + m) * (r + conj(s));
  Complex const second = (conj(p) - m) * (r - conj(s));
  return {0.25f * (first.re - second.im), 0.25f * (first.im + second.re)};
}

}  // namespace gladstone::cuda::inline correlation
