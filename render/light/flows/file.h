#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "render/base/host_device.h"
#include "render/base/vec.h"
#include "render/files/fields/interpolation.h"

namespace gladstone::inline setup {
class SetupTable;
}

namespace gladstone::inline light {

struct FlowSetup;

/// Velocity on a regular grid, interpolated by cubic B-splines (see velocity_file.h). A view, owns no memory. Beyond
/// the ends of a non-periodic axis the velocity is constant, equal to its value at the boundary.
struct FileFlow {
  static constexpr char const* kind = "file";

  float const* coefficients = nullptr;  ///< [z][y][x][component], one ghost layer on each side; null: zero velocity
  std::ptrdiff_t row = 0, plane = 0;    ///< number of elements between successive rows (y) and planes (z)
  std::array<int, 3> nodes{1, 1, 1};    ///< number of nodes along x, y, z; 1 along z: independent of z
  std::array<bool, 3> periodic{};
  Vec3d origin{};           ///< position of node (0, 0, 0) [m]
  Vec3d inverse_spacing{};  ///< reciprocal of the node spacing [1/m]

  /// Reads the keys into setup.file; the data are read later by load_velocity().
  static FileFlow read(SetupTable& table, FlowSetup& setup);

  /// Returns the velocity [m/s] at a point p [m].
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

  /// Returns true if a point [m] is within the grid.
  bool covers(Vec3d p) const {
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      if (periodic[a] || (axis == 2 && nodes[a] == 1)) continue;
      double const u = (p[axis] - origin[axis]) * inverse_spacing[axis];
      constexpr double rounding = 1e-9;  // tolerance in cells, for a volume that ends at the boundary of the grid
      if (!(u >= -rounding && u <= nodes[a] - 1 + rounding)) return false;
    }
    return true;
  }

 private:
  /// Computes the interpolation weights along an axis at grid coordinate u [1], and returns the index of their first
  /// coefficient.
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
    return cell;  // index 0 is the ghost layer, and the support begins one node before the cell
  }
};

}  // namespace gladstone::inline light
