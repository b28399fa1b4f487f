#include "analysis/correlation/lane_fourier.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "render/base/contracts.h"

namespace gladstone {
namespace {

/// Where a pass reads or writes: complex number i, at a stride; backward transforms exchange real and imaginary parts.
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
/// a times the complex number of its cosine and sine at w.
ComplexLanes turned(ComplexLanes const& a, float const* w) {
  return {w[0] * a.re - w[1] * a.im, w[0] * a.im + w[1] * a.re};
}

/// The Fourier transform of `radix` numbers, in place.
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
  } else {
    // cosines and sines of 2 pi/5 and 4 pi/5
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

struct PassView {
  ComplexLanes const* in;
  int in_stride;
  int filled;
  ComplexLanes* out;
  int out_stride;
};

template <int radix, bool back_in, bool back_out, bool padded>
void run_pass(PassView const& view, int groups, int stride, float const* twiddles) {
  std::ptrdiff_t const in_step = view.in_stride, leg = static_cast<std::ptrdiff_t>(groups) * stride * in_step;
  std::ptrdiff_t const out_step = view.out_stride, arm = stride * out_step;
  ComplexLanes const* in = view.in;
  ComplexLanes* out = view.out;
  for (int p = 0; p < groups; ++p, out += (radix - 1) * arm) {
    float const* const w = twiddles + 2 * (radix - 1) * p;
    for (int q = 0; q < stride; ++q, in += in_step, out += out_step) {
      ComplexLanes v[radix];
      for (int k = 0; k < radix; ++k) {
        bool const read = !padded || q + stride * (p + k * groups) < view.filled;
        v[k] = read ? read_value<back_in>(in[k * leg]) : ComplexLanes{};
      }
      butterfly<radix>(v);
      write_value<back_out>(out[0], v[0]);
      if (p == 0)
        for (int k = 1; k < radix; ++k) write_value<back_out>(out[k * arm], v[k]);
      else
        for (int k = 1; k < radix; ++k) write_value<back_out>(out[k * arm], turned(v[k], w + 2 * (k - 1)));
    }
  }
}

template <bool back_in, bool back_out, bool padded = false>
void run_pass(int radix, PassView const& view, int groups, int stride, float const* twiddles) {
  switch (radix) {
    case 2:
      return run_pass<2, back_in, back_out, padded>(view, groups, stride, twiddles);
    case 3:
      return run_pass<3, back_in, back_out, padded>(view, groups, stride, twiddles);
    case 4:
      return run_pass<4, back_in, back_out, padded>(view, groups, stride, twiddles);
    default:
      return run_pass<5, back_in, back_out, padded>(view, groups, stride, twiddles);
  }
}

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
  int left = size, stride = 1;
  while (left > 1) {
    // odd ones first: they meet the zeros of a padded window
    int const radix = left % 3 == 0 ? 3 : left % 5 == 0 ? 5 : left % 4 == 0 ? 4 : 2;
    int const groups = left / radix;
    passes_.push_back({radix, groups, stride, static_cast<int>(twiddles_.size())});
    for (int p = 0; p < groups; ++p)
      for (int k = 1; k < radix; ++k) {
        double const angle = -2.0 * std::numbers::pi * p * k / left;
        twiddles_.push_back(static_cast<float>(std::cos(angle)));
        twiddles_.push_back(static_cast<float>(std::sin(angle)));
      }
    left = groups;
    stride *= radix;
  }
}

template <bool backward>
void LaneFourier::transform(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, int out_stride,
                            ComplexLanes* scratch) const {
  PassView view{in, in_stride, filled, scratch, 1};
  for (std::size_t i = 0; i < passes_.size(); ++i) {
    Pass const& pass = passes_[i];
    float const* const w = twiddles_.data() + pass.first;
    bool const first = i == 0, last = i + 1 == passes_.size();
    if (last) {
      view.out = out;
      view.out_stride = out_stride;
    }
    if (first && last)
      run_pass<backward, backward, true>(pass.radix, view, pass.groups, pass.stride, w);
    else if (first && filled < size_)
      run_pass<backward, false, true>(pass.radix, view, pass.groups, pass.stride, w);
    else if (first)
      run_pass<backward, false>(pass.radix, view, pass.groups, pass.stride, w);
    else if (last)
      run_pass<false, backward>(pass.radix, view, pass.groups, pass.stride, w);
    else
      run_pass<false, false>(pass.radix, view, pass.groups, pass.stride, w);
    view.in = view.out;
    view.in_stride = 1;
    view.filled = size_;
    view.out = view.out == scratch ? scratch + size_ : scratch;
  }
}

void LaneFourier::forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, int out_stride,
                          ComplexLanes* scratch) const {
  transform<false>(in, in_stride, filled, out, out_stride, scratch);
}

void LaneFourier::inverse(ComplexLanes const* in, int in_stride, ComplexLanes* out, int out_stride,
                          ComplexLanes* scratch) const {
  transform<true>(in, in_stride, size_, out, out_stride, scratch);
}

}  // namespace gladstone
