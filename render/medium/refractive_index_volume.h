#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "render/base/regular_grid.h"
#include "render/medium/index_sample.h"
#include "render/medium/interpolation.h"

namespace gladstone {

/// A gridded refractivity seen by rays: a view, passed by value, that owns nothing.
/// `Dimensions` 3: a volume; 2: a plane that is the same along z (an extruded slice).
/// @tparam T       scalar of the ray
/// @tparam Stored  scalar in memory: float for volumes, double for planes
template <class T, class Stored, class Basis, int Dimensions>
struct GriddedIndex {
  Stored const* coefficients = nullptr;  ///< refractivity minus `offset`, padded, x fastest; node 0 at [padding]
  std::ptrdiff_t row = 0;                ///< elements from one row (y) to the next
  std::ptrdiff_t plane = 0;              ///< elements from one plane (z) to the next
  std::array<int, 3> nodes{1, 1, 1};
  std::array<bool, 3> periodic{false, false, false};
  Vec3<T> origin{};           ///< world position of node (0, 0, 0) [m]
  Vec3<T> inverse_spacing{};  ///< [1/m]
  T offset{};                 ///< refractivity that a coefficient of zero stands for [1]
  Bounds<T> box{};

  static constexpr int padding = 1;
  static constexpr int dimensions = Dimensions;

  GLADSTONE_HD Bounds<T> bounds() const { return box; }

  /// Refractivity and its analytic gradient at p [m]. @pre p lies in bounds() (up to rounding)
  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    constexpr int S = Basis::support;
    T wx[S], dx[S], wy[S], dy[S];
    Stored const* corner = coefficients + locate(0, (p.x - origin.x) * inverse_spacing.x, wx, dx) +
                           row * locate(1, (p.y - origin.y) * inverse_spacing.y, wy, dy);
    if constexpr (Dimensions == 2) {
      Sums const sums = contract_rows(corner, wy, dy);
      return finish(dot_row(sums.value, wx), dot_row(sums.value, dx), dot_row(sums.dy, wx), T(0));
    } else {
      // contract y first for every plane, then z, then x: 12 S + S^2 (2 S) products instead of 4 S^3
      T wz[S], dz[S];
      corner += plane * locate(2, (p.z - origin.z) * inverse_spacing.z, wz, dz);
      Row value{}, along_y{}, along_z{};
      for (int k = 0; k < S; ++k) {
        Sums const sums = contract_rows(corner + k * plane, wy, dy);
        for (int i = 0; i < S; ++i) {
          value.c[i] += wz[k] * sums.value.c[i];
          along_y.c[i] += wz[k] * sums.dy.c[i];
          along_z.c[i] += dz[k] * sums.value.c[i];
        }
      }
      return finish(dot_row(value, wx), dot_row(value, dx), dot_row(along_y, wx), dot_row(along_z, wx));
    }
  }

 private:
  struct Row {
    T c[Basis::support];
  };
  struct Sums {
    Row value;
    Row dy;
  };

  /// Weights on one axis, and the offset of the first coefficient that they belong to.
  GLADSTONE_HD std::ptrdiff_t locate(int axis, T u, T (&w)[Basis::support], T (&d)[Basis::support]) const {
    using std::floor;
    int const count = nodes[static_cast<std::size_t>(axis)];
    int last = count - 2;
    if (periodic[static_cast<std::size_t>(axis)]) {
      u -= T(count) * floor(u / T(count));
      last = count - 1;
    }
    int cell = static_cast<int>(floor(u));
    cell = cell < 0 ? 0 : (cell > last ? last : cell);
    Basis::weigh(u - T(cell), w, d);
    return cell + padding + Basis::first;
  }

  GLADSTONE_HD Sums contract_rows(Stored const* corner, T const (&wy)[Basis::support],
                                  T const (&dy)[Basis::support]) const {
    constexpr int S = Basis::support;
    Sums sums{};
    for (int j = 0; j < S; ++j) {
      for (int i = 0; i < S; ++i) {
        T const c = static_cast<T>(corner[j * row + i]);
        sums.value.c[i] += wy[j] * c;
        sums.dy.c[i] += dy[j] * c;
      }
    }
    return sums;
  }

  GLADSTONE_HD static T dot_row(Row const& a, T const (&w)[Basis::support]) {
    T sum = a.c[0] * w[0];
    for (int i = 1; i < Basis::support; ++i) sum += a.c[i] * w[i];
    return sum;
  }

  GLADSTONE_HD IndexSample<T> finish(T value, T gx, T gy, T gz) const {
    return {offset + value, {gx * inverse_spacing.x, gy * inverse_spacing.y, gz * inverse_spacing.z}};
  }
};

/// Owns a refractivity grid, prefiltered in place for B-splines: natural memory is nodes plus one ghost layer a side.
/// Stored is float (volumes) or double (planes and small volumes). Splines are not-a-knot on open axes, so that they
/// reproduce cubics up to the edge, and periodic on periodic ones.
template <class Stored>
class RefractiveIndexVolume {
 public:
  enum class Interpolation { cubic_bspline, trilinear };

  /// Gives planes of constant z, x fastest: `fill(first_plane, count, out)` with refractivities.
  using PlaneFiller = std::function<void(int first_plane, int count, std::span<float> out)>;

  /// @param grid   nodes, spacing [m], origin [m]; a plane (nodes[2] = 1) has no z dependence
  /// @param scale  stored refractivity = scale times file value plus shift, minus offset()
  /// @throws whatever `fill` throws, Interrupted
  RefractiveIndexVolume(RegularGrid const& grid, Interpolation interpolation, double scale, double shift,
                        PlaneFiller const& fill);

  RegularGrid const& grid() const { return grid_; }
  Interpolation interpolation() const { return interpolation_; }
  double offset() const { return offset_; }
  double lowest() const { return lowest_; }    ///< smallest nodal refractivity
  double highest() const { return highest_; }  ///< largest nodal refractivity
  /// Upper bound of |grad n| [1/m]: a B-spline's derivative is a weighted mean of its coefficients' differences.
  double steepest() const { return steepest_; }
  std::size_t bytes() const { return coefficients_.size() * sizeof(Stored); }
  /// Memory that a grid of this kind needs, before it is allocated [bytes].
  static std::size_t bytes_needed(RegularGrid const& grid);

  /// What a ray sees. `z_low`, `z_high` bound an extruded plane [m] and are ignored for volumes.
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
    for (int axis = 0; axis < 3; ++axis) {
      bool const periodic = grid_.periodic[static_cast<std::size_t>(axis)];
      double const step = grid_.spacing[axis];
      double const low = grid_.origin[axis];
      double const high = low + step * (grid_.nodes[static_cast<std::size_t>(axis)] - 1);
      // tiled without end across the view, but for one period along the line of sight
      seen.box.low[axis] = T(!periodic ? low : (axis == 2 ? low - step / 2 : -unbounded));
      seen.box.high[axis] = T(!periodic ? high : (axis == 2 ? high + step / 2 : unbounded));
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

}  // namespace gladstone
