#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/medium/ray_equation.h"
#include "render/medium/refractive_index_volume.h"

namespace gladstone::inline medium {

/// Gridded refractivity as one polynomial per cell: sum of c x^a y^b z^c over powers below Basis::support, with x, y, z
/// relative to the cell's lower corner [m]. Represents the same field as GriddedIndex with fewer operations but more
/// memory. Horner's scheme needs 123 multiplications for a cubic's value and gradient, against 249 with B-spline
/// weights; every cell stores 64 coefficients. A view, passed by value, owns no memory.
/// @tparam Periodic  true if any axis is periodic
template <class Basis, bool Periodic>
struct CellPolynomials {
  double const* coefficients = nullptr;  ///< [cell][power of z][power of y][power of x]; cells with x fastest
  std::array<int, 3> cells{1, 1, 1};
  std::array<bool, 3> periodic{false, false, false};
  Vec3d origin{};           ///< lower corner of cell (0, 0, 0) [m]
  Vec3d spacing{};          ///< cell size [m]
  Vec3d inverse_spacing{};  ///< reciprocal of the cell size [1/m]
  Vec3d period{};           ///< length of the period, for periodic axes [m]
  Vec3d inverse_period{};   ///< reciprocal of the period [1/m]
  Bounds<double> box{};

  static constexpr int support = Basis::support;
  static constexpr int size = support * support * support;  ///< number of coefficients per cell
  /// 1.5 2^52. Adding it rounds a number to an integer, which is then in the low mantissa bits.
  static constexpr double shift = 6755399441055744.0;

  static constexpr std::size_t most_cells = std::size_t{1} << 32;  ///< limit of the fast 32-bit cell indices

  CellPolynomials() = default;
  /// Creates a view that represents the same field as a grid.
  /// @param values  memory for cell_count() * size coefficients, to be filled by fill_cell()
  /// @pre cell_count() <= most_cells
  template <class Stored>
  CellPolynomials(GriddedIndex<double, Stored, Basis, 3> const& grid, double const* values)
      : coefficients(values), periodic(grid.periodic) {
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      cells[a] = grid.nodes[a] - (periodic[a] ? 0 : 1);
      origin[axis] = grid.origin[axis];
      spacing[axis] = 1 / grid.inverse_spacing[axis];
      inverse_spacing[axis] = grid.inverse_spacing[axis];
      period[axis] = cells[a] / grid.inverse_spacing[axis];
      inverse_period[axis] = grid.inverse_spacing[axis] / cells[a];
      box.low[axis] = grid.box.low[axis];
      box.high[axis] = grid.box.high[axis];
    }
  }

  GLADSTONE_HD Bounds<double> bounds() const { return box; }
  GLADSTONE_HD std::size_t cell_count() const {
    return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]);
  }

  /// Returns the refractivity and its analytic gradient at p [m]. @pre p is within bounds() (up to rounding)
  [[gnu::always_inline]] GLADSTONE_HD IndexSample<double> sample(Vec3d p) const {
    Vec3d local[1];
    double const* const cell = locate(p, local[0]);
    IndexSample<double> at[1];
    evaluate(cell, local, at);
    return at[0];
  }

  /// Samples p and q, both from the polynomial of p's cell.
  /// @pre q is so close to p that the error of extrapolation into the neighbouring cell is negligible
  [[gnu::always_inline]] GLADSTONE_HD void sample_pair(Vec3d p, Vec3d q, IndexSample<double> (&at)[2]) const {
    Vec3d local[2];
    double const* const cell = locate(p, local[0]);
    local[1] = local[0] + (q - p);
    evaluate(cell, local, at);
  }

 private:
  /// Returns the coefficients of the cell that contains p, and p relative to the cell's lower corner [m].
  GLADSTONE_HD double const* locate(Vec3d p, Vec3d& local) const {
    using std::floor;
    std::uint32_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      auto const a = static_cast<std::size_t>(axis);
      local[axis] = p[axis] - origin[axis];
      if constexpr (Periodic) {
        // multiply by the reciprocal: a division needs more device registers
        if (periodic[a]) local[axis] -= period[axis] * floor(local[axis] * inverse_period[axis]);
      }
      double whole;
      int const here = cell_below(local[axis], axis, whole);
      local[axis] -= spacing[axis] * whole;
      cell = cell * static_cast<std::uint32_t>(cells[a]) + static_cast<std::uint32_t>(here);
    }
    return coefficients + static_cast<std::size_t>(cell) * size;
  }

  /// Returns the index of the cell along an axis at a distance x [m] from the origin, clamped to the grid; `whole` is
  /// the index as a number.
  GLADSTONE_HD int cell_below(double x, int axis, double& whole) const {
    double const per_metre = inverse_spacing[axis];
    int const end = cells[static_cast<std::size_t>(axis)] - 1;
#if defined(__CUDA_ARCH__)
    // round down by adding `shift`, since conversions to integers are slow on a device
    int const here = min(max(__double2loint(__fma_rd(x, per_metre, shift)), 0), end);
    whole = __hiloint2double(0x43380000, here) - shift;
    return here;
#else
    using std::floor;
    whole = floor(x * per_metre);
    whole = whole > 0 ? whole : 0;
    whole = whole < end ? whole : end;
    return static_cast<int>(whole);
#endif
  }

  /// Value and derivative of a polynomial by Horner's scheme, at N points.
  template <int N>
  struct Horner {
    double value[N], slope[N];
    /// Adds the next lower coefficient at point n. @param power  power of x that the coefficient multiplies
    GLADSTONE_HD void take(int power, int n, double coefficient, double x) {
      if (power == support - 1) {
        value[n] = coefficient;
        slope[n] = 0;
      } else {
        slope[n] = power == support - 2 ? value[n] : slope[n] * x + value[n];
        value[n] = value[n] * x + coefficient;
      }
    }
    /// Proceeds to the next lower coefficient of Horner's scheme at point n, without updating the derivative.
    GLADSTONE_HD void take_value(int power, int n, double coefficient, double x) {
      value[n] = power == support - 1 ? coefficient : value[n] * x + coefficient;
    }
  };

  template <int N>
  [[gnu::always_inline]] GLADSTONE_HD static void evaluate(double const* cell, Vec3d const (&p)[N],
                                                           IndexSample<double> (&at)[N]) {
    // Contract the powers of x for each row, then those of y and z, for the value and the derivatives along x and y.
    // Coefficients are loaded four at a time.
    constexpr int rows = 4 / support;
    using Four = Lanes<double, 4>;
    Four fetched;
    Horner<N> along_z, x_along_z, y_along_z;
    GLADSTONE_UNROLL
    for (int c = support - 1; c >= 0; --c) {
      Horner<N> along_y, x_along_y;
      GLADSTONE_UNROLL
      for (int b = support - 1; b >= 0; --b) {
        if (b % rows == rows - 1) fetched = Four::fetch_aligned(cell + (c * support + b - (rows - 1)) * support);
        GLADSTONE_UNROLL
        for (int n = 0; n < N; ++n) {
          Horner<1> along_x;
          GLADSTONE_UNROLL
          for (int a = support - 1; a >= 0; --a) along_x.take(a, 0, fetched.lane(b % rows * support + a), p[n].x);
          along_y.take(b, n, along_x.value[0], p[n].y);
          x_along_y.take_value(b, n, along_x.slope[0], p[n].y);
        }
      }
      GLADSTONE_UNROLL
      for (int n = 0; n < N; ++n) {
        along_z.take(c, n, along_y.value[n], p[n].z);
        x_along_z.take_value(c, n, x_along_y.value[n], p[n].z);
        y_along_z.take_value(c, n, along_y.slope[n], p[n].z);
      }
    }
    for (int n = 0; n < N; ++n) {
      at[n] = {along_z.value[n], {x_along_z.value[n], y_along_z.value[n], along_z.slope[n]}};
    }
  }
};

/// Computes the polynomial coefficients of cell (i, j, k) of a grid.
template <class Stored, class Basis>
GLADSTONE_HD void fill_cell(GriddedIndex<double, Stored, Basis, 3> const& grid, int i, int j, int k, double* out) {
  constexpr int S = Basis::support;
  constexpr int first = GriddedIndex<double, Stored, Basis, 3>::padding + Basis::first;
  Stored const* const corner = grid.coefficients + (i + first) + grid.row * (j + first) + grid.plane * (k + first);
  double c[S][S][S];  // [z][y][x]
  for (int z = 0; z < S; ++z) {
    for (int y = 0; y < S; ++y) {
      for (int x = 0; x < S; ++x) c[z][y][x] = static_cast<double>(corner[x + grid.row * y + grid.plane * z]);
    }
  }
  // Convert from node weights to powers of the distance from the corner, one axis at a time.
  auto const transform = [](double* line, int stride, double inverse_spacing) {
    double powers[Basis::support], unit = 1;
    for (int power = 0; power < S; ++power) {
      powers[power] = 0;
      for (int node = 0; node < S; ++node) powers[power] += Basis::power_in_weight(power, node) * line[node * stride];
      powers[power] *= unit;
      unit *= inverse_spacing;
    }
    for (int power = 0; power < S; ++power) line[power * stride] = powers[power];
  };
  for (int a = 0; a < S; ++a) {
    for (int b = 0; b < S; ++b) transform(&c[a][b][0], 1, grid.inverse_spacing.x);
  }
  for (int a = 0; a < S; ++a) {
    for (int b = 0; b < S; ++b) transform(&c[a][0][b], S, grid.inverse_spacing.y);
  }
  for (int a = 0; a < S; ++a) {
    for (int b = 0; b < S; ++b) transform(&c[0][a][b], S * S, grid.inverse_spacing.z);
  }
  c[0][0][0] += grid.offset;
  for (int at = 0; at < S * S * S; ++at) out[at] = c[at / (S * S)][at / S % S][at % S];
}

}  // namespace gladstone::inline medium
