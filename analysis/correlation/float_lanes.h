#pragma once

#include <cstdint>

// These vectors are passed between inlined functions only, so that their ABI does not matter.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

/// SIMD vectors of eight floats, one for each of eight windows processed together (vector extensions of GCC and clang;
/// one AVX register).
namespace gladstone::inline correlation {

constexpr int lane_count = 8;
using FloatLanes = float __attribute__((vector_size(4 * lane_count)));
using IntLanes = std::int32_t __attribute__((vector_size(4 * lane_count)));

inline FloatLanes all_lanes(float s) { return FloatLanes{s, s, s, s, s, s, s, s}; }

/// Eight complex numbers, which occupy one cache line.
struct ComplexLanes {
  FloatLanes re, im;
};

/// Loads eight values from memory of any alignment.
inline FloatLanes load_lanes(float const* from) {
  FloatLanes v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}

inline void store_lanes(float* to, FloatLanes v) { __builtin_memcpy(to, &v, sizeof v); }

/// Loads four values from each of two addresses, `low` into the first four lanes.
inline FloatLanes join_halves(float const* low, float const* high) {
  using Half = float __attribute__((vector_size(16)));
  Half a, b;
  __builtin_memcpy(&a, low, sizeof a);
  __builtin_memcpy(&b, high, sizeof b);
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}

/// Loads an 8x8 block and transposes it: value k of row l becomes lane l of column k.
/// @param row  returns the address of the eight values of a row by its number
template <class Row>
[[gnu::always_inline]] inline void read_columns(Row const& row, FloatLanes (&column)[lane_count]) {
  FloatLanes u[8];
  for (int half = 0; half < 2; ++half) {
    FloatLanes v[4], t[4];
    for (int l = 0; l < 4; ++l) v[l] = join_halves(row(l) + 4 * half, row(l + 4) + 4 * half);
    for (int l = 0; l < 4; l += 2) {
      t[l] = __builtin_shufflevector(v[l], v[l + 1], 0, 8, 1, 9, 4, 12, 5, 13);
      t[l + 1] = __builtin_shufflevector(v[l], v[l + 1], 2, 10, 3, 11, 6, 14, 7, 15);
    }
    for (int l = 0; l < 2; ++l) {
      u[4 * half + 2 * l] = __builtin_shufflevector(t[l], t[l + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      u[4 * half + 2 * l + 1] = __builtin_shufflevector(t[l], t[l + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int k = 0; k < 8; ++k) column[k] = u[k];
}

/// Selects a where the mask is set, b elsewhere.
inline FloatLanes select_lanes(IntLanes mask, FloatLanes a, FloatLanes b) { return mask ? a : b; }
inline FloatLanes larger_lanes(FloatLanes a, FloatLanes b) { return a > b ? a : b; }
inline FloatLanes smaller_lanes(FloatLanes a, FloatLanes b) { return a < b ? a : b; }

/// Returns an integer whose bit l is set if lane l of the mask is set.
inline unsigned bits_of_lanes(IntLanes mask) {
#if defined(__AVX__)
  return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<FloatLanes>(mask)));
#else
  unsigned bits = 0;
  for (int l = 0; l < lane_count; ++l) bits |= mask[l] != 0 ? 1u << l : 0u;
  return bits;
#endif
}

/// Returns the sum of the eight lanes, added in a fixed order.
inline float sum_of_lanes(FloatLanes v) { return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7])); }

/// Rounds down to integers. @pre |a| < 2^31
inline IntLanes floor_lanes(FloatLanes a) {
  IntLanes const cut = __builtin_convertvector(a, IntLanes);
  return cut + (a < __builtin_convertvector(cut, FloatLanes));  // a set mask is -1
}

inline FloatLanes root_lanes(FloatLanes a) {
  FloatLanes r;
  for (int l = 0; l < lane_count; ++l) r[l] = __builtin_sqrtf(a[l]);
  return r;
}

/// Computes the natural logarithm of positive normal numbers, with an error of 2e-7 (absolute or relative, whichever is
/// larger): with x = m 2^e and m in [sqrt(1/2), sqrt(2)), log m = 2 artanh((m - 1)/(m + 1)) by its series.
inline FloatLanes log_lanes(FloatLanes x) {
  IntLanes const bits = reinterpret_cast<IntLanes>(x);
  IntLanes const exponent = (bits - 0x3f3504f3) >> 23;
  FloatLanes const m = reinterpret_cast<FloatLanes>(bits - (exponent << 23));
  FloatLanes const s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  FloatLanes const series = 2.0f + s2 * (0.66666667f + s2 * (0.4f + s2 * (0.28571429f + s2 * 0.22222222f)));
  return __builtin_convertvector(exponent, FloatLanes) * 0.69314718f + s * series;
}

/// Computes exp(x) for |x| < 80, with a relative error of 3e-7.
inline FloatLanes exp_lanes(FloatLanes x) {
  FloatLanes const scaled = x * 1.44269504f;
  IntLanes const whole =
      __builtin_convertvector(scaled + select_lanes(scaled < 0.0f, all_lanes(-0.5f), all_lanes(0.5f)), IntLanes);
  FloatLanes const r = (scaled - __builtin_convertvector(whole, FloatLanes)) * 0.69314718f;
  FloatLanes const series =
      1.0f + r * (1.0f + r * (0.5f + r * (0.16666667f + r * (0.04166667f + r * (0.00833333f + r * 0.00138889f)))));
  return series * reinterpret_cast<FloatLanes>((whole + 127) << 23);
}

}  // namespace gladstone::inline correlation
