#include "tests/benchmarks/plain_loop.h"

#include <algorithm>
#include <cmath>

namespace gladstone::bench {
namespace {

struct Sample {
  double refractivity;
  double gradient[3];
};

void spline_weights(double u, double* w, double* d) {
  double const v = 1 - u;
  w[0] = v * v * v / 6;
  w[1] = 2.0 / 3.0 - u * u + 0.5 * u * u * u;
  w[2] = 2.0 / 3.0 - v * v + 0.5 * v * v * v;
  w[3] = u * u * u / 6;
  d[0] = -0.5 * v * v;
  d[1] = u * (1.5 * u - 2);
  d[2] = v * (2 - 1.5 * v);
  d[3] = 0.5 * u * u;
}

Sample sample(SplineVolume<double> const& volume, Vec3d p) {
  double w[3][4], d[3][4];
  int cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    double const u = (p[axis] - volume.origin[axis]) * volume.inverse_spacing[axis];
    cell[axis] = std::clamp(static_cast<int>(std::floor(u)), 0, volume.nodes[static_cast<std::size_t>(axis)] - 2);
    spline_weights(u - cell[axis], w[axis], d[axis]);
  }
  float const* const c = volume.coefficients + cell[0] + cell[1] * volume.row + cell[2] * volume.plane;
  double value = 0, gx = 0, gy = 0, gz = 0;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      double const ww = w[1][j] * w[2][k], dw = d[1][j] * w[2][k], wd = w[1][j] * d[2][k];
      for (int i = 0; i < 4; ++i) {
        double const term = c[i + j * volume.row + k * volume.plane];
        value += w[0][i] * ww * term;
        gx += d[0][i] * ww * term;
        gy += w[0][i] * dw * term;
        gz += w[0][i] * wd * term;
      }
    }
  }
  return {volume.offset + value,
          {gx * volume.inverse_spacing.x, gy * volume.inverse_spacing.y, gz * volume.inverse_spacing.z}};
}

/// n grad n dt
Vec3d kick(SplineVolume<double> const& volume, Vec3d p, double dt) {
  Sample const s = sample(volume, p);
  double const scale = (1 + s.refractivity) * dt;
  return {scale * s.gradient[0], scale * s.gradient[1], scale * s.gradient[2]};
}

}  // namespace

PlainRay plain_steps(SplineVolume<double> const& volume, Ray<double> const& start, double step, int steps) {
  double const n = 1 + sample(volume, start.position).refractivity;
  double const dt = step / n;
  Vec3d R = start.position, T = start.direction * n;
  for (int i = 0; i < steps; ++i) {
    Vec3d const A = kick(volume, R, dt);
    Vec3d const B = kick(volume, R + (0.5 * T + 0.125 * A) * dt, dt);
    Vec3d const C = kick(volume, R + (T + 0.5 * B) * dt, dt);
    R += (T + (1.0 / 6.0) * (A + 2.0 * B)) * dt;
    T += (1.0 / 6.0) * (A + 4.0 * B + C);
  }
  return {R, T};
}

}  // namespace gladstone::bench
