#pragma once

#include <cstddef>
#include <limits>

#include "render/focused_dots/trace_pair.h"

namespace gladstone {

/// What the medium does to a ray, as the camera sees it.
struct Deflection {
  Vec2d displacement;  ///< on the sensor [px]
  Vec2d bend;          ///< on the lens plane [m]
};

/// A square lattice of a plane, and cubic Lagrange polynomials through the sixteen nodes about a point of it (at its
/// edges beside the point).
struct SquareLattice {
  Vec2d first{};       ///< node (0, 0) [m]
  double spacing = 1;  ///< [m]
  double per_metre = 1;
  int columns = 0;
  int rows = 0;

  GLADSTONE_HD long long size() const { return static_cast<long long>(columns) * rows; }
  GLADSTONE_HD Vec2d node(int column, int row) const { return {first.x + column * spacing, first.y + row * spacing}; }
  /// Whether it may be asked within `reach` of a point in either direction.
  GLADSTONE_HD bool covers(Vec2d middle, double reach) const {
    return middle.x - reach >= first.x && middle.y - reach >= first.y &&
           middle.x + reach <= first.x + (columns - 1) * spacing && middle.y + reach <= first.y + (rows - 1) * spacing;
  }

  /// The nodes about a point and their weights along both axes.
  struct Stencil {
    long long corner;
    int columns;
    double x[4], y[4];
  };
  /// @pre covers(q, 0)
  GLADSTONE_HD Stencil about(Vec2d q) const {
    double const u = (q.x - first.x) * per_metre, v = (q.y - first.y) * per_metre;
    int const column = inside(static_cast<int>(u), columns), row = inside(static_cast<int>(v), rows);
    Stencil stencil;
    stencil.corner = static_cast<long long>(row - 1) * columns + (column - 1);
    stencil.columns = columns;
    weigh(u - column, stencil.x);
    weigh(v - row, stencil.y);
    return stencil;
  }

 private:
  GLADSTONE_HD static int inside(int i, int count) { return i < 1 ? 1 : (i > count - 3 ? count - 3 : i); }
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
struct alignas(16) KeptVector {
  double x, y;

  GLADSTONE_HD static KeptVector of(Vec2d v) { return {v.x, v.y}; }
  GLADSTONE_HD friend Vec2d operator*(double scale, KeptVector const& v) { return {scale * v.x, scale * v.y}; }
};

/// Slopes as a table keeps them: what is a correction does with single precision, and half the memory to read, at once.
struct alignas(16) KeptSlopes {
  Vec2<float> by_x, by_y;

  GLADSTONE_HD static KeptSlopes of(PupilSlopes const& s) {
    return {{static_cast<float>(s.by_x.x), static_cast<float>(s.by_x.y)},
            {static_cast<float>(s.by_y.x), static_cast<float>(s.by_y.y)}};
  }
  GLADSTONE_HD friend PupilSlopes operator*(double scale, KeptSlopes const& s) {
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

  /// [rows][columns] of the lattices, as in Deflection; NaN where a ray does not reach the lens; null: no table
  KeptVector const* displacements = nullptr;
  KeptVector const* bends = nullptr;
  KeptSlopes const* displacement_slopes = nullptr;
  KeptSlopes const* bend_slopes = nullptr;

  GLADSTONE_HD bool exists() const { return displacements != nullptr; }
  /// Memory that its values take [bytes].
  std::size_t bytes() const {
    return 2 * (static_cast<std::size_t>(straight.size()) * sizeof(KeptVector) +
                static_cast<std::size_t>(sloping.size()) * sizeof(KeptSlopes));
  }
  /// Whether it holds all rays from within `half` of a point of the target to within `pupil` of the axis.
  GLADSTONE_HD bool covers(Vec2d on_target, double half, double pupil) const {
    Vec2d const middle = (1 - way) * on_target;
    double const reach = (1 - way) * half + way * pupil;
    return exists() && straight.covers(middle, reach) && sloping.covers(middle, reach);
  }
  /// Where the straight ray from a point of the target to one of the pupil crosses the mid-plane [m].
  GLADSTONE_HD Vec2d crossing(Vec2d on_target, Vec2d pupil) const { return (1 - way) * on_target + way * pupil; }
  GLADSTONE_HD Vec2d displacement(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), displacements) +
           interpolate<PupilSlopes>(sloping.about(q), displacement_slopes).at(pupil);
  }
  GLADSTONE_HD Vec2d bend(Vec2d q, Vec2d pupil) const {
    return interpolate<Vec2d>(straight.about(q), bends) +
           interpolate<PupilSlopes>(sloping.about(q), bend_slopes).at(pupil);
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

/// Slopes of displacement and bend, by central differences of four rays.
struct DeflectionSlopes {
  KeptSlopes displacement, bend;
};
/// The pupil point of the first ray, along +x, or the others, along -x, +y and -y [m].
GLADSTONE_HD inline Vec2d slope_pupil(DeflectionTable const& table, int side) {
  double const aside = side % 2 == 0 ? table.pupil_step : -table.pupil_step;
  return side < 2 ? Vec2d{aside, 0} : Vec2d{0, aside};
}
GLADSTONE_HD inline DeflectionSlopes slopes_of(DeflectionTable const& table, Deflection const (&sides)[4]) {
  double const scale = 0.5 / table.pupil_step;
  auto const slopes = [&](Vec2d Deflection::*what) {
    return KeptSlopes::of({scale * (sides[0].*what - sides[1].*what), scale * (sides[2].*what - sides[3].*what)});
  };
  return {slopes(&Deflection::displacement), slopes(&Deflection::bend)};
}

}  // namespace gladstone
