#pragma once

#include <cstdint>

#include "render/base/host_device.h"

namespace gladstone::inline base {

/// Number of dimensions of the Sobol sequence.
inline constexpr int sobol_dimensions = 4;

namespace detail {

GLADSTONE_HD inline std::uint32_t reverse_bits(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
  return __brev(x);
#else
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  return (x >> 16) | (x << 16);
#endif
}

/// Direction numbers of the first four dimensions, shifted to 32-bit binary fractions, v_k = m_k 2^(31-k) (Joe & Kuo,
/// SIAM J. Sci. Comput. 30 (2008) 2635, new-joe-kuo-6). Primitive polynomials: 1 (van der Corput), x + 1, x^2 + x + 1,
/// x^3 + x + 1.
struct SobolDirections {
  std::uint32_t v[sobol_dimensions][32];
};

constexpr SobolDirections make_sobol_directions() {
  SobolDirections d{};
  for (int k = 0; k < 32; ++k) d.v[0][k] = 1u << (31 - k);
  constexpr int degree[4] = {0, 1, 2, 3};
  constexpr std::uint32_t coefficients[4] = {0, 0, 1, 1};
  constexpr std::uint32_t initial[4][3] = {{}, {1}, {1, 3}, {1, 3, 1}};
  for (int dimension = 1; dimension < sobol_dimensions; ++dimension) {
    int const s = degree[dimension];
    auto& v = d.v[dimension];
    for (int k = 0; k < s; ++k) v[k] = initial[dimension][k] << (31 - k);
    for (int k = s; k < 32; ++k) {
      v[k] = v[k - s] ^ (v[k - s] >> s);
      for (int i = 1; i < s; ++i) {
        if ((coefficients[dimension] >> (s - 1 - i)) & 1u) v[k] ^= v[k - i];
      }
    }
  }
  return d;
}

}  // namespace detail

/// Returns the coordinate of point `index` of the Sobol sequence as a 32-bit binary fraction.
GLADSTONE_HD inline std::uint32_t sobol_bits(std::uint32_t index, int dimension) {
  constexpr detail::SobolDirections directions = detail::make_sobol_directions();
  std::uint32_t x = 0;
  for (int k = 0; index != 0; index >>= 1, ++k) {
    if (index & 1u) x ^= directions.v[dimension][k];
  }
  return x;
}

/// Computes sobol_bits() of point `index` for all dimensions, without a branch per bit.
GLADSTONE_HD inline void sobol_point(std::uint32_t index, std::uint32_t (&x)[sobol_dimensions]) {
  constexpr detail::SobolDirections directions = detail::make_sobol_directions();
  x[0] = detail::reverse_bits(index);  // Dimension 0 is the van der Corput sequence.
  for (int dimension = 1; dimension < sobol_dimensions; ++dimension) x[dimension] = 0;
  for (int k = 0; k < 32; ++k) {
    if (k % 8 == 0 && index >> k == 0) return;
    std::uint32_t const bit = 0u - ((index >> k) & 1u);
    for (int dimension = 1; dimension < sobol_dimensions; ++dimension) x[dimension] ^= bit & directions.v[dimension][k];
  }
}

namespace detail {

/// owen_scramble() of a coordinate whose bits are reversed: the first digit is in bit 0.
GLADSTONE_HD inline std::uint32_t scramble_digits(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

}  // namespace detail

/// Scrambles a coordinate by hash-based Owen scrambling (Laine & Karras 2011 with Vegdahl's constants; Burley, JCGT
/// 9(4) (2020)): each bit is flipped depending on a hash of the higher bits. Equal seeds give equal scramblings.
GLADSTONE_HD inline std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed) {
  return detail::reverse_bits(detail::scramble_digits(detail::reverse_bits(x), seed));
}

}  // namespace gladstone::inline base
