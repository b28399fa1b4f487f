#pragma once

#include <limits>

#include "render/scene/trace_pair.h"

namespace gladstone {

/// What the medium does to a ray, as the camera sees it.
struct Deflection {
  Vec2d displacement;  ///< on the sensor [px]
  Vec2d bend;          ///< on the lens plane [m]
};

/// Deflections on a square lattice of a plane, as a view.
struct DeflectionLattice {
  /// [rows][columns], as in Deflection; NaN where the ray does not reach the lens
  Vec2d const* displacements = nullptr;
  Vec2d const* bends = nullptr;
  Vec2d first{};       ///< node (0, 0) [m]
  double spacing = 1;  ///< [m]
  int columns = 0;
  int rows = 0;

  GLADSTONE_HD long long size() const { return static_cast<long long>(columns) * rows; }
  GLADSTONE_HD Vec2d node(int column, int row) const { return {first.x + column * spacing, first.y + row * spacing}; }
  /// Whether it may be asked within `reach` of a point in either direction.
  GLADSTONE_HD bool covers(Vec2d middle, double reach) const {
    return middle.x - reach >= first.x && middle.y - reach >= first.y &&
           middle.x + reach <= first.x + (columns - 1) * spacing && middle.y + reach <= first.y + (rows - 1) * spacing;
  }
  /// @pre covers(q, 0)
  GLADSTONE_HD Vec2d displacement(Vec2d q) const { return interpolate(displacements, q); }
  GLADSTONE_HD Vec2d bend(Vec2d q) const { return interpolate(bends, q); }

 private:
  /// By cubic Lagrange polynomials through the sixteen nodes about a point, at the lattice's edges beside it.
  GLADSTONE_HD Vec2d interpolate(Vec2d const* nodes, Vec2d q) const {
    double const u = (q.x - first.x) / spacing, v = (q.y - first.y) / spacing;
    int const column = inside(static_cast<int>(u), columns), row = inside(static_cast<int>(v), rows);
    double x[4], y[4];
    weigh(u - column, x);
    weigh(v - row, y);
    Vec2d sum{};
    for (int j = 0; j < 4; ++j) {
      Vec2d const* const line = nodes + static_cast<long long>(row - 1 + j) * columns + (column - 1);
      sum += y[j] * (x[0] * line[0] + x[1] * line[1] + x[2] * line[2] + x[3] * line[3]);
    }
    return sum;
  }
  GLADSTONE_HD static int inside(int i, int count) { return i < 1 ? 1 : (i > count - 3 ? count - 3 : i); }
  /// Of the nodes -1, 0, 1, 2 at t (Abramowitz & Stegun 25.2.13).
  GLADSTONE_HD static void weigh(double t, double (&weights)[4]) {
    double const left = t * (t - 1) / 6, right = (t + 1) * (t - 2) / 2;
    weights[0] = left * (2 - t);
    weights[1] = right * (t - 1);
    weights[2] = -right * t;
    weights[3] = left * (t + 1);
  }
};

/// The deflections of rays through the mid-plane of the medium, to first order in the point of the pupil that they run
/// to: what a ray does hangs on where it crosses the mid-plane, and little on its direction.
struct DeflectionTable {
  DeflectionLattice straight;     ///< of rays to the middle of the pupil
  DeflectionLattice by_pupil[2];  ///< change per metre of the pupil point along x and y
  double way = 0;                 ///< from the target to the mid-plane, as a share of the way to the lens [1]
  double pupil_step = 0;          ///< for differences [m]

  /// The straight lattice (axis -1) or one of the slopes'.
  GLADSTONE_HD DeflectionLattice& lattice(int axis) { return axis < 0 ? straight : by_pupil[axis]; }
  GLADSTONE_HD bool exists() const { return straight.displacements != nullptr; }
  /// Whether it holds all rays from within `half` of a point of the target to within `pupil` of the axis.
  GLADSTONE_HD bool covers(Vec2d on_target, double half, double pupil) const {
    Vec2d const middle = (1 - way) * on_target;
    double const reach = (1 - way) * half + way * pupil;
    return exists() && straight.covers(middle, reach) && by_pupil[0].covers(middle, reach);
  }

  /// Where the straight ray from a point of the target to one of the pupil crosses the mid-plane [m].
  GLADSTONE_HD Vec2d crossing(Vec2d on_target, Vec2d pupil) const { return (1 - way) * on_target + way * pupil; }
  GLADSTONE_HD Vec2d displacement(Vec2d q, Vec2d pupil) const {
    return straight.displacement(q) + pupil.x * by_pupil[0].displacement(q) + pupil.y * by_pupil[1].displacement(q);
  }
  GLADSTONE_HD Vec2d bend(Vec2d q, Vec2d pupil) const {
    return straight.bend(q) + pupil.x * by_pupil[0].bend(q) + pupil.y * by_pupil[1].bend(q);
  }
};

/// What the medium does to the ray to a point of the pupil that crosses the mid-plane at q. NaN: it gets lost.
/// @param open the scene without its stop
template <class Medium>
GLADSTONE_HD Deflection deflect(SceneView<double> const& open, Medium const& medium, double way, Vec2d q, Vec2d pupil) {
  Vec2d const from = (q - way * pupil) / (1 - way);
  Vec3d const start{from.x, from.y, open.sources.plane_z};
  Ray<double> const ray{start, normalized(Vec3d{pupil.x - from.x, pupil.y - from.y, open.bundle.lens_z - start.z})};
  RayHit<double> const reference = through_camera(open, ray, 1.0), flow = follow(open, medium, ray, 1.0);
  double const undefined = std::numeric_limits<double>::quiet_NaN();
  if (!reaches_sensor_plane(flow.status)) return {{undefined, undefined}, {undefined, undefined}};
  return {flow.pixel - reference.pixel, flow.at_lens - reference.at_lens};
}

/// What a node of the table holds: of its straight lattice (axis -1), or of the slopes' along x (0) or y (1), by
/// central differences.
template <class Medium>
GLADSTONE_HD Deflection node_deflection(SceneView<double> const& open, Medium const& medium,
                                        DeflectionTable const& table, Vec2d q, int axis) {
  if (axis < 0) return deflect(open, medium, table.way, q, {});
  Deflection sum{};
  for (int side = -1; side <= 1; side += 2) {
    double const aside = side * table.pupil_step, scale = 0.5 / aside;
    Deflection const there = deflect(open, medium, table.way, q, axis == 0 ? Vec2d{aside, 0} : Vec2d{0, aside});
    sum.displacement += scale * there.displacement;
    sum.bend += scale * there.bend;
  }
  return sum;
}

}  // namespace gladstone
