#include <algorithm>
#include <cmath>

#include "analysis/correlation/optical_flow/dense_flow.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr int patch_px = 8;
constexpr int spacing_px = 4;
constexpr int steps = 16;           ///< of a patch at most
constexpr float still_px = 0.002f;  ///< a step below which a patch has come to rest
/// Level whose flow is taken for the frames': single pixels' noise is blurred there.
constexpr std::size_t finest_level = 1;
constexpr float far_px = patch_px;  ///< from where it started: lost, and put back
constexpr std::size_t patch_rows_at_once = 4;

/// A level of the flow frame between its pixels.
using FlowImage = BsplineView<float>;

float value_at(FlowImage const& image, int x, int y, Vec2<float> d) {
  // beyond the border the outermost pixels go on
  int const i = x < 0 ? 0 : (x < image.columns ? x : image.columns - 1);
  int const j = y < 0 ? 0 : (y < image.rows ? y : image.rows - 1);
  return image.sample<3>(i, j, d.x, d.y);
}

/// How a patch differs there from the flow frame, mean grey levels aside: its variance.
float misfit(GreyImage const& reference, FlowImage const& flow, int x, int y, Vec2<float> d) {
  float sum = 0.0f, squares = 0.0f;
  for (int j = 0; j < patch_px; ++j)
    for (int i = 0; i < patch_px; ++i) {
      float const difference = value_at(flow, x + i, y + j, d) - reference(x + i, y + j);
      sum += difference;
      squares += difference * difference;
    }
  return squares - sum * sum / (patch_px * patch_px);
}

/// Finds where the patch of the reference whose first pixel is (x, y) fits the flow frame, mean grey levels aside.
Vec2<float> search(GreyImage const& reference, FlowImage const& flow, int x, int y, Vec2<float> const start) {
  float gx[patch_px][patch_px], gy[patch_px][patch_px];
  float xx = 0.0f, xy = 0.0f, yy = 0.0f, sum_x = 0.0f, sum_y = 0.0f;
  for (int j = 0; j < patch_px; ++j)
    for (int i = 0; i < patch_px; ++i) {
      gx[j][i] = 0.5f * (reference(x + i + 1, y + j) - reference(x + i - 1, y + j));
      gy[j][i] = 0.5f * (reference(x + i, y + j + 1) - reference(x + i, y + j - 1));
      sum_x += gx[j][i];
      sum_y += gy[j][i];
    }
  constexpr float pixels = patch_px * patch_px;
  for (int j = 0; j < patch_px; ++j)
    for (int i = 0; i < patch_px; ++i) {
      // a change of the patch's mean explains nothing
      gx[j][i] -= sum_x / pixels;
      gy[j][i] -= sum_y / pixels;
      xx += gx[j][i] * gx[j][i];
      xy += gx[j][i] * gy[j][i];
      yy += gy[j][i] * gy[j][i];
    }
  float const determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-6f * (xx + yy) * (xx + yy))) return start;
  Vec2<float> d = start;
  for (int step = 0; step < steps; ++step) {
    float bx = 0.0f, by = 0.0f;
    for (int j = 0; j < patch_px; ++j)
      for (int i = 0; i < patch_px; ++i) {
        float const difference = value_at(flow, x + i, y + j, d) - reference(x + i, y + j);
        bx += gx[j][i] * difference;
        by += gy[j][i] * difference;
      }
    Vec2<float> const change{(yy * bx - xy * by) / determinant, (xx * by - xy * bx) / determinant};
    d = d - change;
    if (!(length(d - start) <= far_px)) return start;
    if (length(change) < still_px) break;
  }
  return misfit(reference, flow, x, y, d) <= misfit(reference, flow, x, y, start) ? d : start;
}

}  // namespace

DenseFlow dense_inverse_search(GreyImage const& reference, GreyImage const& flow) {
  std::vector<GreyImage> const first = pyramid_of(reference), second = pyramid_of(flow);
  DenseFlow d(first.back().columns, first.back().rows);
  for (std::size_t level = first.size(); level-- > std::min(finest_level, first.size() - 1);) {
    GreyImage const &a = first[level], &other = second[level];
    BsplineImage<float> const spline(other.columns, other.rows, 3, [&](int i, int j) { return other(i, j); });
    FlowImage const b = spline.view();
    if (level + 1 < first.size()) d = d.finer(a.columns, a.rows);
    // patches reach over the border by half of themselves, so that as many hold an outer pixel as an inner one
    int const across = (a.columns + patch_px / 2) / spacing_px + 1, down = (a.rows + patch_px / 2) / spacing_px + 1;
    std::vector<Vec2<float>> found(static_cast<std::size_t>(across) * down);
    auto const first_pixel = [](int index) { return index * spacing_px - patch_px / 2; };
    parallel_chunks(static_cast<std::size_t>(down), patch_rows_at_once, [&](std::size_t begin, std::size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
        for (int column = 0; column < across; ++column) {
          int const x = first_pixel(column), y = first_pixel(row);
          Vec2d const start = d.at({x + 0.5 * (patch_px - 1), y + 0.5 * (patch_px - 1)});
          found[static_cast<std::size_t>(row) * across + column] =
              search(a, b, x, y, {static_cast<float>(start.x), static_cast<float>(start.y)});
        }
    });
    // every pixel: the mean of the patches that hold it, by the inverse of the difference that each leaves there
    parallel_chunks(static_cast<std::size_t>(a.rows), 16, [&](std::size_t begin, std::size_t end) {
      for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
        for (int i = 0; i < a.columns; ++i) {
          float u = 0.0f, v = 0.0f, weights = 0.0f;
          int const last_column = (i + patch_px / 2) / spacing_px, last_row = (j + patch_px / 2) / spacing_px;
          for (int row = std::max(0, last_row - 1); row <= std::min(last_row, down - 1); ++row)
            for (int column = std::max(0, last_column - 1); column <= std::min(last_column, across - 1); ++column) {
              Vec2<float> const of = found[static_cast<std::size_t>(row) * across + column];
              float const left = value_at(b, i, j, of) - a(i, j);
              float const weight = 1.0f / std::max(0.1f, std::abs(left));
              u += weight * of.x;
              v += weight * of.y;
              weights += weight;
            }
          d.u[d.index(i, j)] = u / weights;
          d.v[d.index(i, j)] = v / weights;
        }
    });
  }
  while (d.columns < reference.columns) d = d.finer(reference.columns, reference.rows);
  // it belongs to where the reference's dots are: the same at mid-position, by fixed-point iteration
  DenseFlow middle(d.columns, d.rows);
  for (int j = 0; j < d.rows; ++j)
    for (int i = 0; i < d.columns; ++i) {
      Vec2d const centre{static_cast<double>(i), static_cast<double>(j)};
      Vec2d value = d.at(centre);
      for (int k = 0; k < 3; ++k) value = d.at(centre - 0.5 * value);
      middle.u[middle.index(i, j)] = static_cast<float>(value.x);
      middle.v[middle.index(i, j)] = static_cast<float>(value.y);
    }
  return middle;
}

}  // namespace gladstone
