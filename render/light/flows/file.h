#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "render/base/fields/interpolation.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

class SetupTable;
struct FlowSetup;

/// Velocity on a regular grid (velocity_file.h), between whose nodes it is a cubic B-spline: a view that owns nothing.
/// Beyond an open axis' ends the velocity is that of the end.
struct FileFlow {
  static constexpr char const* kind = "file";

  float const* coefficients = nullptr;  ///< u, v, w side by side, x fastest, one layer about the nodes; null: at rest
  std::ptrdiff_t row = 0, plane = 0;    ///< coefficients from one row (y), one plane (z) to the next
  std::array<int, 3> nodes{1, 1, 1};    ///< along z 1: the same everywhere
  std::array<bool, 3> periodic{};
  Vec3d origin{};           ///< place of node (0, 0, 0) [m]
  Vec3d inverse_spacing{};  ///< [1/m]

  /// Reads the keys into setup.file; load_velocity() does the rest.
  static FileFlow read(SetupTable& table, FlowSetup& setup);

  /// [m/s]
  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    if (!coefficients) return {};
    T wx[4], wy[4], wz[4], slope[4];
    float const* corner = coefficients + 3 * locate(0, (p.x - T(origin.x)) * T(inverse_spacing.x), wx, slope) +
                          row * locate(1, (p.y - T(origin.y)) * T(inverse_spacing.y), wy, slope);
    int planes = 1;
    wz[0] = T(1);
    if (nodes[2] > 1) {
      corner += plane * locate(2, (p.z - T(origin.z)) * T(inverse_spacing.z), wz, slope);
      planes = 4;
    }
    T sum[3] = {};
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < 4; ++j) {
        float const* const c = corner + k * plane + j * row;
        T const w = wz[k] * wy[j];
        for (int i = 0; i < 4; ++i) {
          for (int a = 0; a < 3; ++a) sum[a] += w * wx[i] * T(c[3 * i + a]);
        }
      }
    }
    return {sum[0], sum[1], sum[2]};
  }

  /// Whether a place lies between the nodes.
  bool covers(Vec3d p) const {
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      if (periodic[a] || (axis == 2 && nodes[a] == 1)) continue;
      double const u = (p[axis] - origin[axis]) * inverse_spacing[axis];
      constexpr double rounding = 1e-9;  // of a cell: a volume may end where the field does
      if (!(u >= -rounding && u <= nodes[a] - 1 + rounding)) return false;
    }
    return true;
  }

 private:
  /// Weights on an axis, and the number of the first coefficient that they belong to.
  template <class T>
  GLADSTONE_HD std::ptrdiff_t locate(int axis, T u, T (&w)[4], T (&slope)[4]) const {
    using std::floor;
    int const count = nodes[static_cast<std::size_t>(axis)];
    int last = count - 2;
    if (periodic[static_cast<std::size_t>(axis)]) {
      u -= T(count) * floor(u / T(count));
      last = count - 1;
    } else {
      u = u > T(0) ? u : T(0);
      u = u < T(count - 1) ? u : T(count - 1);
    }
    int cell = static_cast<int>(u);
    cell = cell < last ? cell : last;
    CubicBspline::weigh(u - T(cell), w, slope);
    return cell;  // the layer before the first node is number 0, and support begins a node before the cell
  }
};

}  // namespace gladstone
