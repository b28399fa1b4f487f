#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "render/medium/ray_equation.h"
#include "render/medium/refractive_index_volume.h"

namespace gladstone {

/// A gridded refractivity as one polynomial a cell: sum of c x^a y^b z^c over powers below Basis::support, with x, y
/// and z counted from the cell's lower corner [m]. What GriddedIndex says in fewer operations and more memory: no
/// weights, and by Horner's scheme 123 products for a cubic's value and gradient instead of 249, but 64 coefficients
/// for every cell. A view, passed by value, that owns nothing.
/// @tparam T        scalar of the ray and in memory
/// @tparam Periodic whether any axis repeats
template <class T, class Basis, bool Periodic>
struct CellPolynomials {
  T const* coefficients = nullptr;  ///< of cell after cell, x fastest; within a cell powers of x fastest
  std::array<int, 3> cells{1, 1, 1};
  std::array<bool, 3> periodic{false, false, false};
  Vec3<T> origin{};           ///< lower corner of cell (0, 0, 0) [m]
  Vec3<T> spacing{};          ///< [m]
  Vec3<T> inverse_spacing{};  ///< [1/m]
  Vec3<T> period{};           ///< of axes that are periodic [m]
  Vec3<T> inverse_period{};   ///< [1/m]
  Vec3<T> last{};             ///< the last cell along each axis, plus `shift` [1]
  Bounds<T> box{};

  static constexpr int support = Basis::support;
  static constexpr int size = support * support * support;  ///< coefficients of a cell
  /// 1.5 2^52 or 1.5 2^23: added, it pushes a fraction out of the mantissa and leaves a whole number in its low bits.
  static constexpr T shift = sizeof(T) == sizeof(double) ? T(6755399441055744.0) : T(12582912.0);

  static constexpr std::size_t most_cells = std::size_t{1} << 32;  ///< so that a cell's number is quick to find

  CellPolynomials() = default;
  /// The same medium as a grid. @param values room for cell_count() * size coefficients, which fill_cell gives
  /// @pre cell_count() <= most_cells
  template <class Stored>
  CellPolynomials(GriddedIndex<double, Stored, Basis, 3> const& grid, T const* values)
      : coefficients(values), periodic(grid.periodic) {
    for (int axis = 0; axis < 3; ++axis) {
      auto const a = static_cast<std::size_t>(axis);
      cells[a] = grid.nodes[a] - (periodic[a] ? 0 : 1);
      origin[axis] = T(grid.origin[axis]);
      spacing[axis] = T(1 / grid.inverse_spacing[axis]);
      inverse_spacing[axis] = T(grid.inverse_spacing[axis]);
      period[axis] = T(cells[a] / grid.inverse_spacing[axis]);
      inverse_period[axis] = T(grid.inverse_spacing[axis] / cells[a]);
      last[axis] = shift + T(cells[a] - 1);
      box.low[axis] = T(grid.box.low[axis]);
      box.high[axis] = T(grid.box.high[axis]);
    }
  }

  GLADSTONE_HD Bounds<T> bounds() const { return box; }
  GLADSTONE_HD std::size_t cell_count() const {
    return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]) * static_cast<std::size_t>(cells[2]);
  }

  /// Refractivity and its analytic gradient at p [m]. @pre p lies in bounds() (up to rounding)
  [[gnu::always_inline]] GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    Vec3<T> local[1];
    T const* const cell = locate(p, local[0]);
    IndexSample<T> at[1];
    evaluate(cell, local, at);
    return at[0];
  }

  /// The same at p and at q, both by the polynomial of p's cell. @pre they lie so near each other that it does not
  /// matter on which side of a cell's face q is
  [[gnu::always_inline]] GLADSTONE_HD void sample_beside(Vec3<T> p, Vec3<T> q, IndexSample<T> (&at)[2]) const {
    Vec3<T> local[2];
    T const* const cell = locate(p, local[0]);
    local[1] = local[0] + (q - p);
    evaluate(cell, local, at);
  }

 private:
  /// The coefficients of p's cell, and p in it [m].
  GLADSTONE_HD T const* locate(Vec3<T> p, Vec3<T>& local) const {
    using std::floor;
    std::uint32_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
      auto const a = static_cast<std::size_t>(axis);
      local[axis] = p[axis] - origin[axis];
      if constexpr (Periodic) {
        // no division: it would cost a device registers
        if (periodic[a]) local[axis] -= period[axis] * floor(local[axis] * inverse_period[axis]);
      }
      T whole;
      int const here = cell_below(local[axis], axis, whole);
      local[axis] -= spacing[axis] * whole;
      cell = cell * static_cast<std::uint32_t>(cells[a]) + static_cast<std::uint32_t>(here);
    }
    return coefficients + static_cast<std::size_t>(cell) * size;
  }

  /// The cell, from 0 to the last, that x [m] lies in along an axis; `whole` is its number.
  GLADSTONE_HD int cell_below(T x, int axis, T& whole) const {
    T const per_metre = inverse_spacing[axis];
#if defined(__CUDA_ARCH__)
    // rounded down by an addition: a device converts slowly
    int here;
    if constexpr (sizeof(T) == sizeof(double)) {
      int const end = cells[static_cast<std::size_t>(axis)] - 1;
      here = min(max(__double2loint(__fma_rd(x, per_metre, shift)), 0), end);
      whole = __hiloint2double(0x43380000, here) - shift;
    } else {
      float const shifted = fminf(fmaxf(__fmaf_rd(x, per_metre, shift), shift), last[axis]);
      here = __float_as_int(shifted) - 0x4b400000;
      whole = shifted - shift;
    }
    return here;
#else
    using std::floor;
    T const end = last[axis] - shift;
    whole = floor(x * per_metre);
    whole = whole > T(0) ? whole : T(0);
    whole = whole < end ? whole : end;
    return static_cast<int>(whole);
#endif
  }

  /// A polynomial's value and slope by Horner's scheme, at several points.
  template <int N>
  struct Horner {
    T value[N], slope[N];
    /// Takes the next lower coefficient. @param power its power
    GLADSTONE_HD void take(int power, int n, T coefficient, T x) {
      if (power == support - 1) {
        value[n] = coefficient;
        slope[n] = T(0);
      } else {
        slope[n] = power == support - 2 ? value[n] : slope[n] * x + value[n];
        value[n] = value[n] * x + coefficient;
      }
    }
    /// The same where the slope is not asked for.
    GLADSTONE_HD void take_value(int power, int n, T coefficient, T x) {
      value[n] = power == support - 1 ? coefficient : value[n] * x + coefficient;
    }
  };

  template <int N>
  [[gnu::always_inline]] GLADSTONE_HD static void evaluate(T const* cell, Vec3<T> const (&p)[N],
                                                           IndexSample<T> (&at)[N]) {
    // row by row along x, then along y and z, for the value and the slopes along the axes before; four numbers at a
    // time
    constexpr int rows = 4 / support;
    Lanes<T, 4> fetched;
    Horner<N> along_z, x_along_z, y_along_z;
    GLADSTONE_UNROLL
    for (int c = support - 1; c >= 0; --c) {
      Horner<N> along_y, x_along_y;
      GLADSTONE_UNROLL
      for (int b = support - 1; b >= 0; --b) {
        if (b % rows == rows - 1) fetched = Lanes<T, 4>::fetch_aligned(cell + (c * support + b - (rows - 1)) * support);
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

/// The coefficients of cell (i, j, k) of a grid.
template <class T, class Stored, class Basis>
GLADSTONE_HD void fill_cell(GriddedIndex<double, Stored, Basis, 3> const& grid, int i, int j, int k, T* out) {
  constexpr int S = Basis::support;
  constexpr int first = GriddedIndex<double, Stored, Basis, 3>::padding + Basis::first;
  Stored const* const corner = grid.coefficients + (i + first) + grid.row * (j + first) + grid.plane * (k + first);
  double c[S][S][S];  // [z][y][x]
  for (int z = 0; z < S; ++z) {
    for (int y = 0; y < S; ++y) {
      for (int x = 0; x < S; ++x) c[z][y][x] = static_cast<double>(corner[x + grid.row * y + grid.plane * z]);
    }
  }
  // axis by axis from weights of the nodes to powers of the way from the corner
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
  for (int at = 0; at < S * S * S; ++at) out[at] = static_cast<T>(c[at / (S * S)][at / S % S][at % S]);
}

}  // namespace gladstone
