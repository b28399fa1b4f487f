#include "tests/benchmarks/plain_loops.h"

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

namespace {

constexpr int window = 32, reach = 8;

/// Copies a window as single precision, less its mean.
template <int Size>
void copy_without_mean(Image<double> const& image, int left, int top, float (&values)[Size][Size]) {
  double sum = 0;
  for (int row = 0; row < Size; ++row) {
    for (int column = 0; column < Size; ++column) sum += image(left + column, top + row);
  }
  double const mean = sum / (Size * Size);
  for (int row = 0; row < Size; ++row) {
    for (int column = 0; column < Size; ++column) {
      values[row][column] = static_cast<float>(image(left + column, top + row) - mean);
    }
  }
}

}  // namespace

int plain_correlation(Image<double> const& first, Image<double> const& second) {
  int found = 0;
  float a[window][window], b[window + 2 * reach][window + 2 * reach];
  for (int top = reach; top + window + reach <= first.rows(); top += window / 2) {
    for (int left = reach; left + window + reach <= first.columns(); left += window / 2) {
      copy_without_mean(first, left, top, a);
      copy_without_mean(second, left - reach, top - reach, b);
      float largest = 0;
      for (int dy = 0; dy <= 2 * reach; ++dy) {
        for (int dx = 0; dx <= 2 * reach; ++dx) {
          float lane[8] = {};
          for (int row = 0; row < window; ++row) {
            for (int column = 0; column < window; column += 8) {
              for (int i = 0; i < 8; ++i) lane[i] += a[row][column + i] * b[row + dy][column + dx + i];
            }
          }
          float sum = 0;
          for (float const one : lane) sum += one;
          largest = std::max(largest, sum);
        }
      }
      found += largest > 0;
    }
  }
  return found;
}

Image<double> plain_images(std::span<Vec2d const> places, double sigma, int columns, int rows) {
  Image<double> image(columns, rows);
  double const scale = 1 / (std::sqrt(2.0) * sigma);
  int const half = static_cast<int>(std::ceil(5 * sigma));
  for (Vec2d const place : places) {
    int const x = static_cast<int>(std::lround(place.x)), y = static_cast<int>(std::lround(place.y));
    for (int row = std::max(0, y - half); row <= std::min(rows - 1, y + half); ++row) {
      double const down = 0.5 * (std::erf((row + 0.5 - place.y) * scale) - std::erf((row - 0.5 - place.y) * scale));
      for (int column = std::max(0, x - half); column <= std::min(columns - 1, x + half); ++column) {
        image(column, row) +=
            down * 0.5 * (std::erf((column + 0.5 - place.x) * scale) - std::erf((column - 0.5 - place.x) * scale));
      }
    }
  }
  return image;
}

}  // namespace gladstone::bench
