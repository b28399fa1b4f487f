#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "render/base/ray.h"
#include "render/medium/trace_medium.h"

namespace gladstone::inline focused_dots {

/// Set-up whose lens images the target sharply: wherever a ray passes the lens, it lands on the image of its apparent
/// point of origin on the target.
struct FocusedSetupView {
  double plane_z = 0, lens_z = 0;  ///< Z of the target and of the lens [m]
  double px_per_metre = 0;         ///< image scale: pixels per metre on the target [px/m]
  TracingOptions<double> tracing;

  GLADSTONE_HD Ray<double> straight_ray(Vec2d from, Vec2d pupil) const {
    return {{from.x, from.y, plane_z}, normalized(Vec3d{pupil.x - from.x, pupil.y - from.y, lens_z - plane_z})};
  }
};

/// Effect of the medium on a ray as seen by the camera.
struct Deflection {
  Vec2d displacement;                   ///< displacement on the sensor [px]; NaN if the ray is lost
  Vec2d shift;                          ///< deflection on the lens plane [m]; NaN if the ray is lost
  RayStatus status = RayStatus::alive;  ///< alive, or the cause of the loss before the lens
};

/// Computes the effect of the medium on N rays, traced together.
/// @param from  starting points on the target [m]
/// @param pupil  intersections of the undeflected rays with the lens plane [m]
template <int N, class Medium>
GLADSTONE_HD void deflect(FocusedSetupView const& bench, Medium const& medium, Vec2d const (&from)[N],
                          Vec2d const (&pupil)[N], Deflection (&out)[N]) {
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

/// Square lattice with nodes at integer multiples of its spacing, and bicubic Lagrange interpolation from the 4 x 4
/// nodes around a point (near an edge, from the outermost four). In the interior, interpolated values do not depend on
/// the extent of the lattice.
struct SquareLattice {
  Vec2<int> first{0, 0};  ///< position of node (0, 0) in multiples of the spacing
  double spacing = 1;     ///< node spacing [m]
  double per_metre = 1;   ///< reciprocal of the spacing [1/m]
  int columns = 0;
  int rows = 0;

  GLADSTONE_HD long long size() const { return static_cast<long long>(columns) * rows; }
  GLADSTONE_HD Vec2d node(int column, int row) const {
    return {(first.x + column) * spacing, (first.y + row) * spacing};
  }
  /// Returns true if the lattice contains the square of half side `reach` around a point.
  GLADSTONE_HD bool covers(Vec2d middle, double reach) const {
    return (middle.x - reach) * per_metre >= first.x && (middle.y - reach) * per_metre >= first.y &&
           (middle.x + reach) * per_metre <= first.x + columns - 1 &&
           (middle.y + reach) * per_metre <= first.y + rows - 1;
  }

  /// The 4 x 4 nodes around a point and their weights along both axes.
  struct Stencil {
    long long corner;
    int columns;
    double x[4], y[4];
  };
  /// Returns the stencil of a point; a point outside the lattice is extrapolated.
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
  /// Returns the node below a position, in multiples of the spacing, limited to nodes that have one node below and two
  /// above.
  GLADSTONE_HD static int inside(double at, int first_node, int count) {
    using std::floor;
    int const low = first_node + 1, high = first_node + count - 3;
    return at < low ? low : (at >= high ? high : static_cast<int>(floor(at)));
  }
  /// Computes the Lagrange weights of the nodes -1, 0, 1, 2 at t (Abramowitz & Stegun 25.2.13).
  GLADSTONE_HD static void weigh(double t, double (&weights)[4]) {
    double const left = (1.0 / 6) * t * (t - 1), right = 0.5 * (t + 1) * (t - 2);
    weights[0] = left * (2 - t);
    weights[1] = right * (t - 1);
    weights[2] = -right * t;
    weights[3] = left * (t + 1);
  }
};

/// Interpolates a value from the nodes of a lattice.
/// @tparam Sum  type of the sum of weights times nodes
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

/// Derivatives of a vector with respect to the pupil point along x and y [1/m].
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

/// Vector in a table, aligned so that it is loaded by one instruction.
struct alignas(16) TableVector {
  double x, y;

  GLADSTONE_HD static TableVector of(Vec2d v) { return {v.x, v.y}; }
  GLADSTONE_HD friend Vec2d operator*(double scale, TableVector const& v) { return {scale * v.x, scale * v.y}; }
};

/// Slopes in a table, aligned for one load. Single precision suffices for a correction and halves the memory traffic.
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

/// Deflections of rays as a function of their intersection q with the mid-plane of the medium, to first order in the
/// pupil point. A ray's deflection depends mainly on q and weakly on its direction. A non-owning view.
struct DeflectionTable {
  SquareLattice straight;  ///< deflections of the rays to the pupil's centre
  SquareLattice sloping;   ///< slopes: derivatives of the deflections with respect to the pupil point, which are small
                           ///< corrections
  double mid_plane_fraction = 0;  ///< distance from the target to the medium's mid-plane, over that to the lens [1]
  double pupil_step = 0;          ///< step in the pupil for the finite differences of the slopes [m]
  Vec2d low, high;                ///< bounds of the medium in X and Y [m]
  double face_fractions[2]{};  ///< distances from the target to the two faces of the medium normal to Z, over that to
                               ///< the lens [1]

  /// [rows][columns] of the lattices, as in Deflection; NaN if a ray does not reach the lens; null: no table
  TableVector const* displacements = nullptr;
  TableVector const* shifts = nullptr;
  TableSlopes const* displacement_slopes = nullptr;
  TableSlopes const* shift_slopes = nullptr;

  /// Pointers to the values in one contiguous block of memory.
  struct Values {
    TableVector *displacements, *shifts;
    TableSlopes *displacement_slopes, *shift_slopes;
  };
  Values values_in(void* memory) const {
    auto* const vectors = static_cast<TableVector*>(memory);
    auto* const slopes = reinterpret_cast<TableSlopes*>(vectors + 2 * straight.size());
    return {vectors, vectors + straight.size(), slopes, slopes + sloping.size()};
  }
  /// Returns a copy of the table that refers to the given values.
  DeflectionTable with(Values const& values) const {
    DeflectionTable table = *this;
    table.displacements = values.displacements;
    table.shifts = values.shifts;
    table.displacement_slopes = values.displacement_slopes;
    table.shift_slopes = values.shift_slopes;
    return table;
  }
  GLADSTONE_HD bool exists() const { return displacements != nullptr; }
  /// Memory of the values [bytes].
  std::size_t bytes() const {
    return 2 * (static_cast<std::size_t>(straight.size()) * sizeof(TableVector) +
                static_cast<std::size_t>(sloping.size()) * sizeof(TableSlopes));
  }
  /// Returns true if the table contains the rays from all points within `half` of a point on the target to all points
  /// within `radius` of a point in the pupil.
  GLADSTONE_HD bool covers(Vec2d on_target, double half, Vec2d pupil, double radius) const {
    Vec2d const middle = crossing(on_target, pupil);
    double const reach = (1 - mid_plane_fraction) * half + mid_plane_fraction * radius;
    return exists() && straight.covers(middle, reach) && sloping.covers(middle, reach);
  }
  /// Returns true if the medium is not crossed by any straight ray from a point within `half` of a point on the target
  /// to a point within `pupil` of the axis.
  GLADSTONE_HD bool beside(Vec2d on_target, double half, double pupil) const {
    bool left = true, right = true, below = true, above = true;
    for (int face = 0; face < 2; ++face) {  // A cone extends farthest at one of its ends.
      double const share = face_fractions[face], reach = (1 - share) * half + share * pupil;
      Vec2d const middle = (1 - share) * on_target;
      left = left && middle.x + reach < low.x;
      right = right && middle.x - reach > high.x;
      below = below && middle.y + reach < low.y;
      above = above && middle.y - reach > high.y;
    }
    return left || right || below || above;
  }
  /// Returns the intersection with the mid-plane of the straight ray between a point on the target and one in the pupil
  /// [m].
  GLADSTONE_HD Vec2d crossing(Vec2d on_target, Vec2d pupil) const {
    return (1 - mid_plane_fraction) * on_target + mid_plane_fraction * pupil;
  }
  GLADSTONE_HD Vec2d displacement(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), displacements) +
           interpolate<PupilSlopes>(sloping.about(q), displacement_slopes).at(pupil);
  }
  GLADSTONE_HD Vec2d shift(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), shifts) +
           interpolate<PupilSlopes>(sloping.about(q), shift_slopes).at(pupil);
  }
  /// Number of groups of four rays from which the table is built. The first straight_fours() groups are rays to the
  /// pupil's centre through the nodes of `straight`; then follows a group for every node of `sloping`, whose rays pass
  /// the pupil points +x, -x, +y and -y.
  GLADSTONE_HD long long straight_fours() const { return (straight.size() + 3) / 4; }
  GLADSTONE_HD long long fours() const { return straight_fours() + sloping.size(); }
};

/// Traces group `which` of four rays of a table and stores their results.
/// @tparam Four  lanes that share the four rays; each traces `abreast` of them together
template <class Four, class Medium>
GLADSTONE_HD void trace_ray_group(Four const& four, FocusedSetupView const& bench, Medium const& medium,
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
    from[i] = (crossing - table.mid_plane_fraction * pupil[i]) / (1 - table.mid_plane_fraction);
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
  // Compute the slopes by central differences.
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

}  // namespace gladstone::inline focused_dots
