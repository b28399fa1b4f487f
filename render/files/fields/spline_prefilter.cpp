#include "render/files/fields/spline_prefilter.h"

#include <cmath>
#include <cstddef>

namespace gladstone::inline files {

void prefilter_open(std::span<double> line, std::span<double> scratch) {
  std::size_t const n = line.size() - 2;
  double* const c = line.data() + 1;  // c[0..n-1]: nodes, c[-1] and c[n]: ghosts
  if (n == 1) {
    c[-1] = c[1] = c[0];
    return;
  }
  if (n == 2) {
    c[-1] = 2 * c[0] - c[1];
    c[2] = 2 * c[1] - c[0];
    return;
  }
  if (n == 3) {
    double const curvature = c[0] - 2 * c[1] + c[2];
    for (std::size_t i = 0; i < 3; ++i) c[i] -= curvature / 6;
    c[-1] = 2 * c[0] - c[1] + curvature;
    c[3] = 2 * c[2] - c[1] + curvature;
    return;
  }
  double const f_first = c[0], f_second = c[1], f_penultimate = c[n - 2], f_last = c[n - 1];
  double const c_second = f_second - (f_first - 2 * f_second + c[2]) / 6;
  double const c_penultimate = f_penultimate - (c[n - 3] - 2 * f_penultimate + f_last) / 6;
  c[1] = c_second;
  c[n - 2] = c_penultimate;
  // c_{i-1} + 4 c_i + c_{i+1} = 6 f_i for i = 2 .. n-3, with c_1 and c_{n-2} known
  double* const upper = scratch.data();
  double pivot_upper = 0;
  double previous = c[1];
  for (std::size_t i = 2; i + 2 < n; ++i) {
    double const diagonal = 4 - pivot_upper;
    double const right = 6 * c[i] - previous - (i + 3 == n ? c[n - 2] : 0.0);
    upper[i] = 1 / diagonal;
    c[i] = right / diagonal;
    pivot_upper = upper[i];
    previous = c[i];
  }
  for (std::size_t i = n - 3; i-- > 2;) c[i] -= upper[i] * c[i + 1];
  c[0] = 6 * f_second - 4 * c[1] - c[2];
  c[n - 1] = 6 * f_penultimate - 4 * c[n - 2] - c[n - 3];
  c[-1] = 6 * f_first - 4 * c[0] - c[1];
  c[n] = 6 * f_last - 4 * c[n - 1] - c[n - 2];
}

void prefilter_periodic(std::span<double> line) {
  std::size_t const n = line.size();
  double const z = std::sqrt(3.0) - 2;
  double const closure = 1 / (1 - std::pow(z, static_cast<double>(n)));
  // Causal pass: y_i = f_i + z y_{i-1}, with y_{-1} from the sum over one period.
  double power = 1, sum = 0;
  for (std::size_t i = n; i-- > 0;) {
    sum += power * line[i];
    power *= z;
    if (std::abs(power) < 1e-20) break;
  }
  double y = sum * closure;
  for (std::size_t i = 0; i < n; ++i) y = line[i] += z * y;
  // Anticausal pass: c_i = z (c_{i+1} - y_i), started from c_n = -z sum z^k y_k over one period; then the gain 6.
  power = z, sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    sum += power * line[i];
    power *= z;
    if (std::abs(power) < 1e-20) break;
  }
  double c = -sum * closure;
  for (std::size_t i = n; i-- > 0;) {
    c = z * (c - line[i]);
    line[i] = 6 * c;
  }
}

}  // namespace gladstone::inline files
