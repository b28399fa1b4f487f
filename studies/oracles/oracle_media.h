#pragma once

#include <cmath>

#include "render/medium/index_sample.h"

/// Media with closed-form ray paths, used by `gladstone validate` and the tests.
namespace gladstone::inline oracles::oracle {

/// n^2 = n0^2 + 2 a x: every ray is a parabola in Sharma's parameter, R = R_0 + T_0 t + a t^2/2 (Ghatak & Thyagarajan).
struct LinearSquaredIndex {
  double n0 = 1;
  double a = 0.02;
  Bounds<double> box{{-unbounded, -unbounded, 0}, {unbounded, unbounded, 10}};

  Bounds<double> bounds() const { return box; }
  IndexSample<double> sample(Vec3d p) const {
    double const n = std::sqrt(n0 * n0 + 2 * a * p.x);
    return {n - 1, {a / n, 0, 0}};
  }
};

/// n^2 = n0^2 (1 - g^2 r^2), r from the z axis: r = r_0 cos(w z / p_z) + (p_x / w) sin(w z / p_z), w = n0 g.
struct ParabolicRod {
  double n0 = 1.5916;
  double g = 0.1;
  double length = 20;

  Bounds<double> bounds() const { return {{-9, -9, 0}, {9, 9, length}}; }
  double squared_index(Vec3d p) const { return n0 * n0 * (1 - g * g * (p.x * p.x + p.y * p.y)); }
  IndexSample<double> sample(Vec3d p) const {
    double const n = std::sqrt(squared_index(p));
    double const slope = -n0 * n0 * g * g / n;
    return {n - 1, {slope * p.x, slope * p.y, 0}};
  }
};

/// n^2 = 2 - r^2 inside the unit sphere (Luneburg 1944): parallel light is focused to a point on the surface.
struct LuneburgSphere {
  Bounds<double> bounds() const { return {{-1, -1, -1}, {1, 1, 1}}; }
  IndexSample<double> sample(Vec3d p) const {
    double const n = std::sqrt(2 - dot(p, p));
    return {n - 1, p * (-1 / n)};
  }
};

/// n = 2 / (1 + r^2) (Maxwell 1854): rays are circles, and every point is imaged stigmatically to its antipode.
struct FishEye {
  double half_width = 3;

  Bounds<double> bounds() const {
    return {{-half_width, -half_width, -half_width}, {half_width, half_width, half_width}};
  }
  IndexSample<double> sample(Vec3d p) const {
    double const n = 2 / (1 + dot(p, p));
    return {n - 1, p * (-n * n)};
  }
};

}  // namespace gladstone::inline oracles::oracle
