#include "analysis/correlation/lane_fourier.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <type_traits>

#include "render/base/contracts.h"

namespace gladstone::inline correlation {
namespace {

/// Reads a complex number. For a backward transform, read_value() and write_value() exchange real and imaginary parts,
/// so that the passes of a forward transform compute the backward one.
template <bool backward>
ComplexLanes read_value(ComplexLanes const& v) {
  if constexpr (backward) return {v.im, v.re};
  return v;
}

template <bool backward>
void write_value(ComplexLanes& to, ComplexLanes const& v) {
  if constexpr (backward)
    to = {v.im, v.re};
  else
    to = v;
}

ComplexLanes operator+(ComplexLanes const& a, ComplexLanes const& b) { return {a.re + b.re, a.im + b.im}; }
ComplexLanes operator-(ComplexLanes const& a, ComplexLanes const& b) { return {a.re - b.re, a.im - b.im}; }
ComplexLanes operator*(float s, ComplexLanes const& a) { return {s * a.re, s * a.im}; }
ComplexLanes times_minus_i(ComplexLanes const& a) { return {a.im, -a.re}; }
ComplexLanes operator*(ComplexLanes const& a, ComplexLanes const& w) {
  return {w.re * a.re - w.im * a.im, w.re * a.im + w.im * a.re};
}

/// Computes the Fourier transform of `radix` numbers in place.
template <int radix>
[[gnu::always_inline]] inline void butterfly(ComplexLanes (&v)[radix]) {
  if constexpr (radix == 2) {
    ComplexLanes const a = v[0], b = v[1];
    v[0] = a + b;
    v[1] = a - b;
  } else if constexpr (radix == 3) {
    constexpr float root = 0.86602540378443865f;  // sqrt(3)/2
    ComplexLanes const sum = v[1] + v[2], difference = root * times_minus_i(v[1] - v[2]);
    ComplexLanes const middle = v[0] - 0.5f * sum;
    v[0] = v[0] + sum;
    v[1] = middle + difference;
    v[2] = middle - difference;
  } else if constexpr (radix == 4) {
    ComplexLanes const a = v[0] + v[2], b = v[0] - v[2], c = v[1] + v[3], d = times_minus_i(v[1] - v[3]);
    v[0] = a + c;
    v[1] = b + d;
    v[2] = a - c;
    v[3] = b - d;
  } else if constexpr (radix == 6) {
    // Prime-factor algorithm (Good & Thomas) for six values: one transform of the three even values, and one of the
    // three odd values shifted by three. It needs no twiddle factors between the transforms.
    ComplexLanes even[3] = {v[0], v[2], v[4]}, odd[3] = {v[3], v[5], v[1]};
    butterfly<3>(even);
    butterfly<3>(odd);
    v[0] = even[0] + odd[0];
    v[3] = even[0] - odd[0];
    v[4] = even[1] + odd[1];
    v[1] = even[1] - odd[1];
    v[2] = even[2] + odd[2];
    v[5] = even[2] - odd[2];
  } else if constexpr (radix == 8) {
    ComplexLanes even[4] = {v[0], v[2], v[4], v[6]}, odd[4] = {v[1], v[3], v[5], v[7]};
    butterfly<4>(even);
    butterfly<4>(odd);
    constexpr float half = 0.70710678118654752f;  // sqrt(1/2)
    ComplexLanes const a = half * ComplexLanes{odd[1].re + odd[1].im, odd[1].im - odd[1].re};
    ComplexLanes const b = times_minus_i(odd[2]);
    ComplexLanes const c = half * ComplexLanes{odd[3].im - odd[3].re, -odd[3].re - odd[3].im};
    v[0] = even[0] + odd[0];
    v[4] = even[0] - odd[0];
    v[1] = even[1] + a;
    v[5] = even[1] - a;
    v[2] = even[2] + b;
    v[6] = even[2] - b;
    v[3] = even[3] + c;
    v[7] = even[3] - c;
  } else {
    // Cosines and sines of 2 pi/5 and 4 pi/5.
    constexpr float c1 = 0.30901699437494742f, c2 = -0.80901699437494742f;
    constexpr float s1 = 0.95105651629515357f, s2 = 0.58778525229247313f;
    ComplexLanes const a = v[1] + v[4], b = v[2] + v[3], c = times_minus_i(v[1] - v[4]), d = times_minus_i(v[2] - v[3]);
    ComplexLanes const p = v[0] + c1 * a + c2 * b, q = v[0] + c2 * a + c1 * b;
    ComplexLanes const r = s1 * c + s2 * d, t = s2 * c - s1 * d;
    v[0] = v[0] + a + b;
    v[1] = p + r;
    v[2] = q + t;
    v[3] = q - t;
    v[4] = p - r;
  }
}

/// Returns the radix of the first pass of a transform of `left` values. Radices 6 and 8 need less memory traffic than
/// their factors; odd radices come first, because the first pass can skip the zeros of a padded window.
constexpr int radix_of(int left) {
  if (left % 24 == 0) return 6;
  for (int const radix : {3, 5})
    if (left % radix == 0) return radix;
  // With radix 2 first, two passes of radix 8 follow; with radix 8 first, two passes of radix 4 would follow.
  if (left == 128) return 2;
  if (left % 8 == 0 && left != 16) return 8;
  return left % 4 == 0 ? 4 : 2;
}

template <int n>
using Fixed = std::integral_constant<int, n>;

/// Input and output of a pass. @tparam Stride  int, or Fixed if known at compile time
template <class Stride>
struct PassView {
  ComplexLanes const* in;
  Stride in_stride;
  int filled;
  ComplexLanes* out;
};

/// Performs one pass. @tparam Groups, Stride  int, or Fixed: all strides are then compile-time constants
template <int radix, bool back_in, bool back_out, bool padded, class InStride, class Groups, class Stride>
[[gnu::always_inline]] inline void run_pass(PassView<InStride> view, Groups groups, Stride stride,
                                            ComplexLanes const* twiddles) {
  std::ptrdiff_t const in_step = view.in_stride, leg = groups * stride * in_step;
  auto const butterflies = [&](int p, auto turn) {
    ComplexLanes const* in = view.in + p * stride * in_step;
    ComplexLanes* out = view.out + static_cast<std::ptrdiff_t>(p) * radix * stride;
    for (int q = 0; q < stride; ++q, in += in_step, ++out) {
      ComplexLanes v[radix];
      for (int k = 0; k < radix; ++k) {
        bool const read = !padded || q + stride * (p + k * groups) < view.filled;
        v[k] = read ? read_value<back_in>(in[k * leg]) : ComplexLanes{};
      }
      butterfly<radix>(v);
      write_value<back_out>(out[0], v[0]);
      for (int k = 1; k < radix; ++k) write_value<back_out>(out[k * stride], turn(v[k], k));
    }
  };
  butterflies(0, [](ComplexLanes const& v, int) { return v; });
  for (int p = 1; p < groups; ++p) {
    ComplexLanes const* const w = twiddles + (radix - 1) * p - 1;
    butterflies(p, [w](ComplexLanes const& v, int k) { return v * w[k]; });
  }
}

template <bool back_in, bool back_out, bool padded>
void run_any_pass(int radix, PassView<int> const& view, int groups, int stride, ComplexLanes const* twiddles) {
  auto const run = [&](auto r) {
    run_pass<decltype(r)::value, back_in, back_out, padded>(view, groups, stride, twiddles);
  };
  switch (radix) {
    case 2:
      return run(Fixed<2>{});
    case 3:
      return run(Fixed<3>{});
    case 4:
      return run(Fixed<4>{});
    case 5:
      return run(Fixed<5>{});
    case 6:
      return run(Fixed<6>{});
    default:
      return run(Fixed<8>{});
  }
}

/// Performs all passes of a transform of any size, from the pass with `left` remaining values on.
template <bool backward, bool padded>
void run_any(PassView<int> view, int size, int left, ComplexLanes* scratch, ComplexLanes const* twiddles) {
  ComplexLanes* const out = view.out;
  for (int stride = 1; left > 1;) {
    int const radix = radix_of(left), groups = left / radix;
    bool const first = stride == 1, last = groups == 1;
    view.out = last ? out : scratch;
    if (first && last)
      run_any_pass<backward, backward, padded>(radix, view, groups, stride, twiddles);
    else if (first)
      run_any_pass<backward, false, padded>(radix, view, groups, stride, twiddles);
    else if (last)
      run_any_pass<false, backward, false>(radix, view, groups, stride, twiddles);
    else
      run_any_pass<false, false, false>(radix, view, groups, stride, twiddles);
    twiddles += (radix - 1) * groups;
    view = {scratch, 1, size, out};
    scratch += first ? size : -size;
    left = groups;
    stride *= radix;
  }
}

/// Performs all passes like run_any(), for one size, with all strides known at compile time.
template <bool backward, bool padded, int size, int left, class InStride>
void run_fixed(PassView<InStride> view, ComplexLanes* scratch, ComplexLanes const* twiddles) {
  constexpr int radix = radix_of(left), groups = left / radix, stride = size / left;
  constexpr bool first = stride == 1, last = groups == 1;
  ComplexLanes* const out = view.out;
  if constexpr (!last) view.out = scratch;
  run_pass<radix, first && backward, last && backward, first && padded>(view, Fixed<groups>{}, Fixed<stride>{},
                                                                        twiddles);
  if constexpr (!last)
    run_fixed<backward, false, size, groups>(PassView<Fixed<1>>{scratch, {}, size, out},
                                             first ? scratch + size : scratch - size, twiddles + (radix - 1) * groups);
}

template <int size>
void run_forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, ComplexLanes* scratch,
                 ComplexLanes const* twiddles) {
  auto const run = [&](auto stride) {
    PassView<decltype(stride)> const view{in, stride, filled, out};
    if (filled < size)
      run_fixed<false, true, size, size>(view, scratch, twiddles);
    else
      run_fixed<false, false, size, size>(view, scratch, twiddles);
  };
  if (in_stride == 1) return run(Fixed<1>{});
  if (in_stride == LaneFourier::pitch(size)) return run(Fixed<LaneFourier::pitch(size)>{});
  run(in_stride);
}

template <int size>
void run_inverse(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch, ComplexLanes const* twiddles) {
  run_fixed<true, false, size, size>(PassView<Fixed<1>>{in, {}, size, out}, scratch, twiddles);
}

/// Sizes with specialised code: those of the default passes and of common windows.
struct FixedSize {
  int size;
  decltype(&run_forward<4>) forward;
  decltype(&run_inverse<4>) inverse;
};
template <int... sizes>
constexpr std::array<FixedSize, sizeof...(sizes)> fixed_sizes_of() {
  return {FixedSize{sizes, run_forward<sizes>, run_inverse<sizes>}...};
}
constexpr auto fixed_sizes = fixed_sizes_of<16, 24, 32, 40, 48, 64, 96, 128>();

int without_factors(int n) {
  for (int const factor : {2, 3, 5})
    while (n % factor == 0) n /= factor;
  return n;
}

}  // namespace

int lane_fourier_size(int least) {
  int size = (least + 3) / 4 * 4;
  while (without_factors(size) != 1) size += 4;
  return size;
}

LaneFourier::LaneFourier(int size) : size_(size) {
  GLADSTONE_EXPECTS(size >= 4 && size == lane_fourier_size(size));
  for (int left = size; left > 1; left /= radix_of(left)) {
    int const radix = radix_of(left);
    for (int p = 0; p < left / radix; ++p)
      for (int k = 1; k < radix; ++k) {
        double const angle = -2.0 * std::numbers::pi * p * k / left;
        twiddles_.push_back(
            {all_lanes(static_cast<float>(std::cos(angle))), all_lanes(static_cast<float>(std::sin(angle)))});
      }
  }
  for (FixedSize const& row : fixed_sizes)
    if (row.size == size) {
      forward_ = row.forward;
      inverse_ = row.inverse;
    }
}

void LaneFourier::forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out,
                          ComplexLanes* scratch) const {
  if (forward_ != nullptr) return forward_(in, in_stride, filled, out, scratch, twiddles_.data());
  if (filled < size_)
    run_any<false, true>({in, in_stride, filled, out}, size_, size_, scratch, twiddles_.data());
  else
    run_any<false, false>({in, in_stride, filled, out}, size_, size_, scratch, twiddles_.data());
}

void LaneFourier::inverse(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch) const {
  if (inverse_ != nullptr) return inverse_(in, out, scratch, twiddles_.data());
  run_any<true, false>({in, 1, size_, out}, size_, size_, scratch, twiddles_.data());
}

}  // namespace gladstone::inline correlation
