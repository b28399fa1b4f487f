#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "render/base/lanes.h"
#include "render/base/regular_grid.h"
#include "render/files/fields/interpolation.h"
#include "render/medium/index_sample.h"

namespace gladstone::inline medium {

/// View of a gridded refractivity, passed by value; owns no memory. `Dimensions` is 3 for a volume, 2 for a plane that
/// is extruded along z.
/// @tparam T       scalar type of the ray
/// @tparam Stored  scalar type in memory: float for volumes, double for planes
template <class T, class Stored, class Basis, int Dimensions>
struct GriddedIndex {
  Stored const* coefficients = nullptr;  ///< refractivity minus `offset`, padded, x fastest; node 0 at [padding]
  std::ptrdiff_t row = 0;                ///< number of elements between successive rows (y)
  std::ptrdiff_t plane = 0;              ///< number of elements between successive planes (z)
  std::array<int, 3> nodes{1, 1, 1};
  std::array<bool, 3> periodic{false, false, false};
  Vec3<T> origin{};           ///< world position of node (0, 0, 0) [m]
  Vec3<T> inverse_spacing{};  ///< reciprocal of the node spacing [1/m]
  T offset{};                 ///< refractivity represented by a coefficient of zero [1]
  Bounds<T> box{};

  static constexpr int padding = 1;
  static constexpr int dimensions = Dimensions;
  using Interpolant = Basis;

  GLADSTONE_HD Bounds<T> bounds() const { return box; }

  /// Returns the refractivity and its analytic gradient at p [m]. @pre p is within bounds() (up to rounding)
  [[gnu::always_inline]] GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    constexpr int S = Basis::support;
    Row wx, dx, wy, dy;
    Stored const* corner = coefficients + locate(0, (p.x - origin.x) * inverse_spacing.x, wx, dx) +
                           row * locate(1, (p.y - origin.y) * inverse_spacing.y, wy, dy);
    T sum[4];
    if constexpr (Dimensions == 2) {
      Sums const sums = contract_rows(corner, wy, dy);
      scalar_products({sums.value, sums.value, sums.dy, Row::all(T(0))}, {wx, dx, wx, wx}, sum);
    } else {
      // contract y of every plane, then z, then x: 12 S + S^2 (2 S) products instead of 4 S^3
      Row wz, dz;
      corner += plane * locate(2, (p.z - origin.z) * inverse_spacing.z, wz, dz);
      Sums sums = contract_rows(corner, wy, dy);
      Row value = wz.spread(0) * sums.value, along_y = wz.spread(0) * sums.dy, along_z = dz.spread(0) * sums.value;
      for (int k = 1; k < S; ++k) {
        sums = contract_rows(corner + k * plane, wy, dy);
        value = wz.spread(k) * sums.value + value;
        along_y = wz.spread(k) * sums.dy + along_y;
        along_z = dz.spread(k) * sums.value + along_z;
      }
      scalar_products({value, value, along_y, along_z}, {wx, dx, wx, wx}, sum);
    }
    return finish(sum[0], sum[1], sum[2], sum[3]);
  }

 private:
  using Row = Lanes<T, Basis::support>;
  struct Sums {
    Row value;
    Row dy;
  };

  /// Computes the interpolation weights and their derivatives along an axis at grid coordinate u, and returns the
  /// offset of the first coefficient.
  GLADSTONE_HD std::ptrdiff_t locate(int axis, T u, Row& w, Row& d) const {
    using std::floor;
    int const count = nodes[static_cast<std::size_t>(axis)];
    T last = T(count - 2);
    if (periodic[static_cast<std::size_t>(axis)]) {
      u -= T(count) * floor(u / T(count));
      last = T(count - 1);
    }
    T cell = floor(u);
    cell = cell > T(0) ? cell : T(0);
    cell = cell < last ? cell : last;
    Basis::weigh(u - cell, w, d);
    return static_cast<int>(cell) + padding + Basis::first;
  }

  GLADSTONE_HD Sums contract_rows(Stored const* corner, Row const& wy, Row const& dy) const {
    Row c = Row::fetch(corner);
    Sums sums{wy.spread(0) * c, dy.spread(0) * c};
    for (int j = 1; j < Basis::support; ++j) {
      c = Row::fetch(corner + j * row);
      sums.value = wy.spread(j) * c + sums.value;
      sums.dy = dy.spread(j) * c + sums.dy;
    }
    return sums;
  }

  GLADSTONE_HD IndexSample<T> finish(T value, T gx, T gy, T gz) const {
    return {offset + value, {gx * inverse_spacing.x, gy * inverse_spacing.y, gz * inverse_spacing.z}};
  }
};

/// Returns the box of a grid, from first to last node [m]. Periodic axes are infinite across the line of sight, and
/// along the line of sight (z) one period long.
inline Bounds<double> grid_bounds(RegularGrid const& grid) {
  Bounds<double> box{};
  for (int axis = 0; axis < 3; ++axis) {
    bool const periodic = grid.periodic[static_cast<std::size_t>(axis)];
    double const step = grid.spacing[axis];
    double const low = grid.origin[axis];
    double const high = low + step * (grid.nodes[static_cast<std::size_t>(axis)] - 1);
    box.low[axis] = !periodic ? low : (axis == 2 ? low - step / 2 : -unbounded);
    box.high[axis] = !periodic ? high : (axis == 2 ? high + step / 2 : unbounded);
  }
  return box;
}

/// Refractivity on a grid, prefiltered in place for B-splines. Owns the coefficients, which have one ghost layer on
/// each side (two after the last node of a periodic axis). Splines have not-a-knot end conditions on open axes, so that
/// they reproduce cubics up to the boundary, and are periodic on periodic axes.
/// @tparam Stored  float (volumes) or double (planes and small volumes)
template <class Stored>
class RefractiveIndexVolume {
 public:
  enum class Interpolation { cubic_bspline, trilinear };

  /// Callback that provides planes of constant z, x fastest, as file values: `fill(first_plane, count, out)`. Values
  /// are in double precision; only the refractivity minus an offset is rounded to Stored.
  using PlaneFiller = std::function<void(int first_plane, int count, std::span<double> out)>;

  /// @param grid   nodes, spacing [m], origin [m]; a plane (nodes[2] = 1) does not depend on z
  /// @param scale  factor from file values to refractivity
  /// @param shift  added to scale times file value to obtain the refractivity
  /// @param fill   provides the file values
  /// @throws Interrupted and all exceptions of `fill`
  RefractiveIndexVolume(RegularGrid const& grid, Interpolation interpolation, double scale, double shift,
                        PlaneFiller const& fill);

  double lowest() const { return lowest_; }    ///< smallest refractivity at a node
  double highest() const { return highest_; }  ///< largest refractivity at a node
  /// Upper bound of |grad n| [1/m]: a B-spline's derivative is a weighted mean of differences of its coefficients.
  double steepest() const { return steepest_; }
  /// Returns the memory required for a grid [bytes].
  static std::size_t bytes_needed(RegularGrid const& grid);

  /// Returns a view for rays. z_low and z_high are the bounds of an extruded plane [m] and are ignored for volumes.
  template <class T, class Basis, int Dimensions>
  GriddedIndex<T, Stored, Basis, Dimensions> view(double z_low, double z_high) const {
    GriddedIndex<T, Stored, Basis, Dimensions> seen;
    seen.coefficients = coefficients_.data();
    seen.row = row_;
    seen.plane = plane_;
    seen.nodes = grid_.nodes;
    seen.periodic = grid_.periodic;
    seen.origin = {T(grid_.origin.x), T(grid_.origin.y), T(grid_.origin.z)};
    seen.inverse_spacing = {T(1 / grid_.spacing.x), T(1 / grid_.spacing.y), T(1 / grid_.spacing.z)};
    seen.offset = T(offset_);
    Bounds<double> const box = grid_bounds(grid_);
    for (int axis = 0; axis < 3; ++axis) {
      seen.box.low[axis] = T(box.low[axis]);
      seen.box.high[axis] = T(box.high[axis]);
    }
    if (Dimensions == 2) {
      seen.box.low.z = T(z_low);
      seen.box.high.z = T(z_high);
    }
    return seen;
  }

 private:
  std::size_t index(int i, int j, int k) const;
  void prefilter_axis(int axis);
  void copy_ghosts(int axis);
  void measure_steepest();

  RegularGrid grid_;
  Interpolation interpolation_;
  std::array<int, 3> padded_{};
  std::ptrdiff_t row_ = 0;
  std::ptrdiff_t plane_ = 0;
  double offset_ = 0;
  double lowest_ = 0;
  double highest_ = 0;
  double steepest_ = 0;
  std::vector<Stored> coefficients_;
};

extern template class RefractiveIndexVolume<float>;
extern template class RefractiveIndexVolume<double>;

}  // namespace gladstone::inline medium
