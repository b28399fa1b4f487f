#pragma once

#if defined(__AVX2__) && !defined(__CUDACC__)
#define GLADSTONE_AVX2_LANES
#include <immintrin.h>
#endif

#include "render/base/host_device.h"

namespace gladstone::inline base {

/// SIMD vector of N numbers, for sums of products over the rows of an interpolation stencil. The general version is
/// plain loops; with AVX2, four doubles are one vector register (vector type of GCC and clang), with the same
/// operations in the same order.
template <class T, int N>
struct Lanes {
  T v[N];

  GLADSTONE_HD static Lanes all(T s) {
    Lanes a;
    for (int i = 0; i < N; ++i) a.v[i] = s;
    return a;
  }
  template <class Stored>
  GLADSTONE_HD static Lanes load(Stored const* from) {
    Lanes a;
    for (int i = 0; i < N; ++i) a.v[i] = static_cast<T>(from[i]);
    return a;
  }
  /// Loads N numbers from memory that is constant while the kernel runs (read-only cache on a device).
  template <class Stored>
  GLADSTONE_HD static Lanes fetch(Stored const* from) {
#if defined(__CUDA_ARCH__)
    Lanes a;
    for (int i = 0; i < N; ++i) a.v[i] = static_cast<T>(__ldg(from + i));
    return a;
#else
    return load(from);
#endif
  }
  /// Loads an even number N of doubles with the fewest instructions.
  /// @pre `from` is aligned to 16 bytes, and constant while the kernel runs
  GLADSTONE_HD static Lanes fetch_aligned(double const* from) {
    static_assert(N % 2 == 0);
#if defined(__CUDA_ARCH__)
    Lanes a;
    for (int i = 0; i < N; i += 2) {
      double2 const two = __ldg(reinterpret_cast<double2 const*>(from + i));
      a.v[i] = two.x;
      a.v[i + 1] = two.y;
    }
    return a;
#else
    return load(from);
#endif
  }
  GLADSTONE_HD T lane(int i) const { return v[i]; }
  /// Returns a vector with every lane equal to lane `i`.
  GLADSTONE_HD Lanes spread(int i) const { return all(v[i]); }

  GLADSTONE_HD friend Lanes operator+(Lanes a, Lanes const& b) {
    for (int i = 0; i < N; ++i) a.v[i] += b.v[i];
    return a;
  }
  GLADSTONE_HD friend Lanes operator*(Lanes a, Lanes const& b) {
    for (int i = 0; i < N; ++i) a.v[i] *= b.v[i];
    return a;
  }
  /// Clamps every lane to [low, high].
  GLADSTONE_HD Lanes clamped(T low, T high) const {
    Lanes a = *this;
    for (int i = 0; i < N; ++i) a.v[i] = a.v[i] < low ? low : (a.v[i] > high ? high : a.v[i]);
    return a;
  }
};

#ifdef GLADSTONE_AVX2_LANES
template <>
struct Lanes<double, 4> {
  using Register = double __attribute__((vector_size(32)));
  Register v;

  static Lanes all(double s) { return {Register{s, s, s, s}}; }
  static Lanes load(double const* from) { return {_mm256_loadu_pd(from)}; }
  // The intrinsic function is three times as fast as the conversion of four floats that GCC generates.
  static Lanes load(float const* from) { return {_mm256_cvtps_pd(_mm_loadu_ps(from))}; }
  template <class Stored>
  static Lanes fetch(Stored const* from) {
    return load(from);
  }
  static Lanes fetch_aligned(double const* from) { return load(from); }
  double lane(int i) const { return v[i]; }
  Lanes spread(int i) const { return all(v[i]); }

  friend Lanes operator+(Lanes a, Lanes b) { return {a.v + b.v}; }
  friend Lanes operator*(Lanes a, Lanes b) { return {a.v * b.v}; }
  Lanes clamped(double low, double high) const { return {_mm256_min_pd(_mm256_max_pd(v, all(low).v), all(high).v)}; }
};
#endif

/// Computes four dot products over the lanes: out[i] = sum over k of row[i][k] weights[i][k].
template <class T, int N>
GLADSTONE_HD void scalar_products(Lanes<T, N> const (&row)[4], Lanes<T, N> const (&weights)[4], T (&out)[4]) {
#ifdef GLADSTONE_AVX2_LANES
  if constexpr (requires { typename Lanes<T, N>::Register; }) {
    auto const a = row[0].v * weights[0].v, b = row[1].v * weights[1].v;
    auto const c = row[2].v * weights[2].v, d = row[3].v * weights[3].v;
    auto const ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
    auto const cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
    auto const sums = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    for (int i = 0; i < 4; ++i) out[i] = sums[i];
    return;
  }
#endif
  for (int i = 0; i < 4; ++i) {
    out[i] = row[i].v[0] * weights[i].v[0];
    for (int k = 1; k < N; ++k) out[i] += row[i].v[k] * weights[i].v[k];
  }
}

}  // namespace gladstone::inline base
