#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "render/base/ray.h"
#include "render/medium/trace_medium.h"

namespace gladstone {

/// What a ray meets on a bench whose lens images the target sharply: wherever it passes the lens, it lands on the image
/// of the point of the target that it seems to come from.
struct BenchView {
  double plane_z = 0, lens_z = 0;  ///< of the target and of the lens [m]
  double px_per_metre = 0;         ///< of the target [px/m]
  TracingOptions<double> tracing;

  GLADSTONE_HD Ray<double> straight_ray(Vec2d from, Vec2d pupil) const {
    return {{from.x, from.y, plane_z}, normalized(Vec3d{pupil.x - from.x, pupil.y - from.y, lens_z - plane_z})};
  }
};

/// What the medium does to a ray, as the camera sees it.
struct Deflection {
  Vec2d displacement;                   ///< on the sensor [px]
  Vec2d shift;                          ///< on the lens plane [m]
  RayStatus status = RayStatus::alive;  ///< or how it was lost on its way to the lens: NaN then
};

/// What the medium does to N rays, side by side. @param from on the target @param pupil of straight rays [m]
template <int N, class Medium>
GLADSTONE_HD void deflect(BenchView const& bench, Medium const& medium, Vec2d const (&from)[N], Vec2d const (&pupil)[N],
                          Deflection (&out)[N]) {
  Ray<double> start[N];
  for (int i = 0; i < N; ++i) start[i] = bench.straight_ray(from[i], pupil[i]);
  MediumPassage<double> way[N];
  trace_medium(medium, bench.tracing, start, way);
  for (int i = 0; i < N; ++i) {
    out[i] = {};
    if (way[i].status == RayStatus::alive && !way[i].crossed) continue;
    Ray<double> const seen = apparent_ray(start[i], way[i]);
    out[i].status = way[i].status != RayStatus::alive ? way[i].status
                    : seen.direction.z > 0            ? RayStatus::alive
                                                      : RayStatus::missed_lens;
    if (out[i].status != RayStatus::alive) {
      out[i].displacement.x = out[i].displacement.y = std::numeric_limits<double>::quiet_NaN();
      out[i].shift = out[i].displacement;
      continue;
    }
    Vec3d const moved = seen.position - start[i].position;
    double const far = (bench.lens_z - bench.plane_z) / seen.direction.z;
    out[i].displacement = bench.px_per_metre * Vec2d{moved.x, -moved.y};
    out[i].shift = {seen.position.x + far * seen.direction.x - pupil[i].x,
                    seen.position.y + far * seen.direction.y - pupil[i].y};
  }
}

/// A square lattice of a plane whose nodes lie at multiples of its spacing, wherever it begins, and cubic Lagrange
/// polynomials through the sixteen nodes about a point (at its edges beside the point): what it says of a point further
/// inside hangs on nothing else.
struct SquareLattice {
  Vec2<int> first{0, 0};  ///< multiples of the spacing at which node (0, 0) lies
  double spacing = 1;     ///< [m]
  double per_metre = 1;
  int columns = 0;
  int rows = 0;

  GLADSTONE_HD long long size() const { return static_cast<long long>(columns) * rows; }
  GLADSTONE_HD Vec2d node(int column, int row) const {
    return {(first.x + column) * spacing, (first.y + row) * spacing};
  }
  /// Whether it may be asked within `reach` of a point in either direction.
  GLADSTONE_HD bool covers(Vec2d middle, double reach) const {
    return (middle.x - reach) * per_metre >= first.x && (middle.y - reach) * per_metre >= first.y &&
           (middle.x + reach) * per_metre <= first.x + columns - 1 &&
           (middle.y + reach) * per_metre <= first.y + rows - 1;
  }

  /// The nodes about a point and their weights along both axes.
  struct Stencil {
    long long corner;
    int columns;
    double x[4], y[4];
  };
  /// A place beyond the lattice is extrapolated to.
  GLADSTONE_HD Stencil about(Vec2d q) const {
    double const u = q.x * per_metre, v = q.y * per_metre;
    int const column = inside(u, first.x, columns), row = inside(v, first.y, rows);
    Stencil stencil;
    stencil.corner = static_cast<long long>(row - first.y - 1) * columns + (column - first.x - 1);
    stencil.columns = columns;
    weigh(u - column, stencil.x);
    weigh(v - row, stencil.y);
    return stencil;
  }

 private:
  /// The node before a place, in multiples of the spacing, that has one before it and two behind.
  GLADSTONE_HD static int inside(double at, int first_node, int count) {
    using std::floor;
    int const low = first_node + 1, high = first_node + count - 3;
    return at < low ? low : (at >= high ? high : static_cast<int>(floor(at)));
  }
  /// Of the nodes -1, 0, 1, 2 at t (Abramowitz & Stegun 25.2.13).
  GLADSTONE_HD static void weigh(double t, double (&weights)[4]) {
    double const left = (1.0 / 6) * t * (t - 1), right = 0.5 * (t + 1) * (t - 2);
    weights[0] = left * (2 - t);
    weights[1] = right * (t - 1);
    weights[2] = -right * t;
    weights[3] = left * (t + 1);
  }
};

/// Value interpolated from a lattice's nodes. @tparam Sum of weights times nodes
template <class Sum, class Node>
GLADSTONE_HD Sum interpolate(SquareLattice::Stencil const& stencil, Node const* nodes) {
  Sum sum{};
  for (int j = 0; j < 4; ++j) {
    Node const* const line = nodes + stencil.corner + static_cast<long long>(j) * stencil.columns;
    Node const node[4] = {line[0], line[1], line[2], line[3]};
    sum += stencil.y[j] *
           (stencil.x[0] * node[0] + stencil.x[1] * node[1] + stencil.x[2] * node[2] + stencil.x[3] * node[3]);
  }
  return sum;
}

/// How something changes with the point of the pupil: per metre along x and y.
struct PupilSlopes {
  Vec2d by_x, by_y;

  GLADSTONE_HD Vec2d at(Vec2d pupil) const { return pupil.x * by_x + pupil.y * by_y; }
  GLADSTONE_HD friend PupilSlopes operator*(double scale, PupilSlopes const& s) {
    return {scale * s.by_x, scale * s.by_y};
  }
  GLADSTONE_HD friend PupilSlopes operator+(PupilSlopes const& a, PupilSlopes const& b) {
    return {a.by_x + b.by_x, a.by_y + b.by_y};
  }
  GLADSTONE_HD PupilSlopes& operator+=(PupilSlopes const& o) { return *this = *this + o; }
};

/// A vector as a table keeps it, to be read at once.
struct alignas(16) TableVector {
  double x, y;

  GLADSTONE_HD static TableVector of(Vec2d v) { return {v.x, v.y}; }
  GLADSTONE_HD friend Vec2d operator*(double scale, TableVector const& v) { return {scale * v.x, scale * v.y}; }
};

/// Slopes as a table keeps them: what is a correction does with single precision, and half the memory to read, at once.
struct alignas(16) TableSlopes {
  Vec2<float> by_x, by_y;

  GLADSTONE_HD static TableSlopes of(PupilSlopes const& s) {
    return {{static_cast<float>(s.by_x.x), static_cast<float>(s.by_x.y)},
            {static_cast<float>(s.by_y.x), static_cast<float>(s.by_y.y)}};
  }
  GLADSTONE_HD friend PupilSlopes operator*(double scale, TableSlopes const& s) {
    return {{scale * s.by_x.x, scale * s.by_x.y}, {scale * s.by_y.x, scale * s.by_y.y}};
  }
};

/// The deflections of rays through the mid-plane of the medium, to first order in the point of the pupil that they run
/// to: what a ray does hangs on where it crosses the mid-plane, and little on its direction. A view.
struct DeflectionTable {
  SquareLattice straight;  ///< rays to the middle of the pupil
  SquareLattice sloping;   ///< the slopes, which are corrections
  double way = 0;          ///< from the target to the mid-plane, as a share of the way to the lens [1]
  double pupil_step = 0;   ///< for the slopes' differences [m]
  Vec2d low, high;         ///< side faces of the medium [m]
  double face_ways[2]{};   ///< as `way`, of its faces across the axis

  /// [rows][columns] of the lattices, as in Deflection; NaN where a ray does not reach the lens; null: no table
  TableVector const* displacements = nullptr;
  TableVector const* shifts = nullptr;
  TableSlopes const* displacement_slopes = nullptr;
  TableSlopes const* shift_slopes = nullptr;

  /// Memory for its values, as one piece, and where they stand there.
  struct Values {
    TableVector *displacements, *shifts;
    TableSlopes *displacement_slopes, *shift_slopes;
  };
  Values values_in(void* memory) const {
    auto* const vectors = static_cast<TableVector*>(memory);
    auto* const slopes = reinterpret_cast<TableSlopes*>(vectors + 2 * straight.size());
    return {vectors, vectors + straight.size(), slopes, slopes + sloping.size()};
  }
  /// The table whose values stand there.
  DeflectionTable with(Values const& values) const {
    DeflectionTable table = *this;
    table.displacements = values.displacements;
    table.shifts = values.shifts;
    table.displacement_slopes = values.displacement_slopes;
    table.shift_slopes = values.shift_slopes;
    return table;
  }
  GLADSTONE_HD bool exists() const { return displacements != nullptr; }
  /// Memory that its values take [bytes].
  std::size_t bytes() const {
    return 2 * (static_cast<std::size_t>(straight.size()) * sizeof(TableVector) +
                static_cast<std::size_t>(sloping.size()) * sizeof(TableSlopes));
  }
  /// Whether it holds all rays from within `half` of a point of the target to within `radius` of one of the pupil.
  GLADSTONE_HD bool covers(Vec2d on_target, double half, Vec2d pupil, double radius) const {
    Vec2d const middle = crossing(on_target, pupil);
    double const reach = (1 - way) * half + way * radius;
    return exists() && straight.covers(middle, reach) && sloping.covers(middle, reach);
  }
  /// Whether no straight ray from within `half` of a point of the target to within `pupil` of the axis meets the
  /// medium.
  GLADSTONE_HD bool beside(Vec2d on_target, double half, double pupil) const {
    bool left = true, right = true, below = true, above = true;
    for (int face = 0; face < 2; ++face) {  // a cone is furthest out at one of its ends
      double const share = face_ways[face], reach = (1 - share) * half + share * pupil;
      Vec2d const middle = (1 - share) * on_target;
      left = left && middle.x + reach < low.x;
      right = right && middle.x - reach > high.x;
      below = below && middle.y + reach < low.y;
      above = above && middle.y - reach > high.y;
    }
    return left || right || below || above;
  }
  /// Where the straight ray from a point of the target to one of the pupil crosses the mid-plane [m].
  GLADSTONE_HD Vec2d crossing(Vec2d on_target, Vec2d pupil) const { return (1 - way) * on_target + way * pupil; }
  GLADSTONE_HD Vec2d displacement(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), displacements) +
           interpolate<PupilSlopes>(sloping.about(q), displacement_slopes).at(pupil);
  }
  GLADSTONE_HD Vec2d shift(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), shifts) +
           interpolate<PupilSlopes>(sloping.about(q), shift_slopes).at(pupil);
  }
  /// The rays that make it are traced by fours: those of the straight lattice, then four about the pupil for every node
  /// of the slopes', along +x, -x, +y and -y.
  GLADSTONE_HD long long straight_fours() const { return (straight.size() + 3) / 4; }
  GLADSTONE_HD long long fours() const { return straight_fours() + sloping.size(); }
};

/// Traces four of the rays that make a table. @tparam Four lanes that share them, each with `abreast` side by side
template <class Four, class Medium>
GLADSTONE_HD void trace_four(Four const& four, BenchView const& bench, Medium const& medium,
                             DeflectionTable const& table, DeflectionTable::Values const& out, long long which) {
  constexpr int abreast = Four::abreast;
  bool const straight = which < table.straight_fours();
  SquareLattice const& lattice = straight ? table.straight : table.sloping;
  long long node[abreast];
  Vec2d from[abreast], pupil[abreast];
  for (int i = 0; i < abreast; ++i) {
    int const side = four.lane() * abreast + i;
    node[i] = straight ? 4 * which + side : which - table.straight_fours();
    if (node[i] >= lattice.size()) node[i] = lattice.size() - 1;
    double const aside = side % 2 == 0 ? table.pupil_step : -table.pupil_step;
    pupil[i] = straight ? Vec2d{} : (side < 2 ? Vec2d{aside, 0} : Vec2d{0, aside});
    Vec2d const crossing =
        lattice.node(static_cast<int>(node[i] % lattice.columns), static_cast<int>(node[i] / lattice.columns));
    from[i] = (crossing - table.way * pupil[i]) / (1 - table.way);
  }
  Deflection found[abreast];
  deflect(bench, medium, from, pupil, found);
  if (straight) {
    for (int i = 0; i < abreast; ++i) {
      out.displacements[node[i]] = TableVector::of(found[i].displacement);
      out.shifts[node[i]] = TableVector::of(found[i].shift);
    }
    return;
  }
  // slopes by central differences
  double const scale = 0.5 / table.pupil_step;
  auto const slopes = [&](Vec2d Deflection::*what) {
    Vec2d sides[4];
    for (int i = 0; i < 4; ++i) sides[i] = four.of_lane(i / abreast, found[i % abreast].*what);
    return TableSlopes::of({scale * (sides[0] - sides[1]), scale * (sides[2] - sides[3])});
  };
  TableSlopes const displacement = slopes(&Deflection::displacement), shift = slopes(&Deflection::shift);
  if (four.lane() != 0) return;
  out.displacement_slopes[node[0]] = displacement;
  out.shift_slopes[node[0]] = shift;
}

}  // namespace gladstone
