#pragma once

#include <bit>
#include <cstdint>

#include "render/base/host_device.h"
#include "render/base/sobol.h"

/// Order of the points of a scrambled Sobol sequence in which neighbours in the first two dimensions are adjacent.
namespace gladstone::inline base {

namespace detail {

/// Returns the position of the highest bit of x that is set. @pre x > 0
GLADSTONE_HD inline int highest_bit(std::uint32_t x) {
#if defined(__CUDA_ARCH__)
  return 31 - __clz(static_cast<int>(x));
#else
  return 31 - std::countl_zero(x);
#endif
}

/// Returns the bits of x at even positions, packed without gaps.
GLADSTONE_HD inline std::uint32_t even_bits(std::uint32_t x) {
  x &= 0x55555555u;
  x = (x | (x >> 1)) & 0x33333333u;
  x = (x | (x >> 2)) & 0x0f0f0f0fu;
  x = (x | (x >> 4)) & 0x00ff00ffu;
  return (x | (x >> 8)) & 0x0000ffffu;
}

/// Multiplies bits by Pascal's triangle modulo 2: bit q of the result is the sum of C(k, q) x_k, and C(k, q) is odd if
/// k contains all bits of q (Lucas). This is dimension 1 of the sequence, with digit q of the coordinate in bit q. The
/// matrix is its own inverse.
GLADSTONE_HD inline std::uint32_t multiply_by_pascal(std::uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ (x >> 16);
}

/// Inverts the scrambling of the leading digits of a coordinate, the first digit in bit 0. A digit is flipped depending
/// on the digits before it, so that they are found one after the other.
GLADSTONE_HD inline std::uint32_t unscramble_digits(std::uint32_t digits, int count, std::uint32_t seed) {
  std::uint32_t x = 0;
  for (int k = 0; k < count; ++k) x |= (scramble_digits(x, seed) ^ digits) & (1u << k);
  return x;
}

}  // namespace detail

/// Returns the index of the point of the scrambled sequence at position `place` of an order that resembles Morton's
/// (1966). Dimensions 0 and 1 of the sequence are the squared radius and the angle of a point in the unit disc. Points
/// at adjacent positions are neighbours in the disc, for any seeds, so that rays through them read the same cells of a
/// medium. The order is a permutation of the first `count` points.
///
/// An aligned block of 2^m points has exactly one point in each of 2^m equal rectangles, 2^a along the angle by 2^r
/// along the squared radius with a + r = m (Sobol's nets). Within a block, the binary digits of `place` select the
/// rectangle: first a quadrant, then alternately a half of the radii and a half of the angles. The index of the point
/// in the rectangle follows from a system of linear equations modulo 2, which has a closed solution for the first two
/// dimensions. The `count` points are divided into blocks by the binary digits of `count`, the largest first.
/// @param place  position in the order; if it is `count` or more, the result is `place` itself
/// @param radius_seed, angle_seed  seeds of owen_scramble() for dimensions 0 and 1
GLADSTONE_HD inline std::uint32_t ordered_point(std::uint32_t place, std::uint32_t count, std::uint32_t radius_seed,
                                                std::uint32_t angle_seed) {
  if (place >= count) return place;
  int const m = detail::highest_bit(place ^ count);  // the block contains 2^m points
  int const r = m > 0 ? (m - 1) / 2 : 0, a = m - r;
  std::uint32_t const first = (place >> m) << m, angles = (1u << a) - 1;
  // Divide the binary digits of `place` between angle and radius; the first digit is in bit 0.
  std::uint32_t const digits = (detail::reverse_bits(place) >> 1) >> (31 - m);
  std::uint32_t const radius = detail::even_bits(digits >> 2);
  std::uint32_t const angle = (digits & 1u) | (detail::even_bits(digits >> 1) << 1);
  // Dimension 0 reverses the bits of the index, so that its digits are the low bits.
  std::uint32_t const low = first | detail::unscramble_digits(radius, r, radius_seed);
  // The remaining bits of the index follow from the matrix of binomial coefficients C(r + k, q) modulo 2. It is the
  // product of two matrices: Pascal's triangle, and then the multiplication of a polynomial in z by (1 + z)^r, where
  // binary digit q of a coordinate is the coefficient of z^q. Modulo 2 and z^32, the inverse of (1 + z)^r is (1 +
  // z)^(32 - r).
  std::uint32_t rest = (detail::unscramble_digits(angle, a, angle_seed) ^ detail::multiply_by_pascal(low)) & angles;
  for (int k = 0; k < 5; ++k) {
    if (((32 - r) >> k) & 1) rest ^= rest << (1 << k);
  }
  return low | (detail::multiply_by_pascal(rest & angles) << r);
}

}  // namespace gladstone::inline base
