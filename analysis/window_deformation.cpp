#include "analysis/window_deformation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr std::size_t rows_per_chunk = 8;

/// Weights of Keys' kernel (a = -1/2) for the nodes at -1, 0, 1, 2, for a point t past node 0.
void cubic_convolution(double t, double* w) {
  w[0] = 0.5 * t * (-1.0 + t * (2.0 - t));
  w[1] = 1.0 + 0.5 * t * t * (-5.0 + 3.0 * t);
  w[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t));
  w[3] = 0.5 * t * t * (t - 1.0);
}

template <int degree>
void deform_rows(BsplineView<float> reference, BsplineView<float> flow, ImagePair const& original,
                 DensePredictor const& predictor, ImagePair& pair) {
  int const columns = pair.columns, rows = pair.rows;
  auto const inside = [&](float x, float y) {
    return x >= -0.5f && x <= static_cast<float>(columns) - 0.5f && y >= -0.5f && y <= static_cast<float>(rows) - 0.5f;
  };
  auto const known = [&](float x, float y) {
    if (!inside(x, y)) return 0.0f;
    if (original.available.empty()) return 1.0f;
    int const i = std::clamp(static_cast<int>(std::lround(x)), 0, columns - 1);
    int const j = std::clamp(static_cast<int>(std::lround(y)), 0, rows - 1);
    return original.available[static_cast<std::size_t>(j) * columns + i];
  };
  parallel_chunks(static_cast<std::size_t>(rows), rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<float> u(static_cast<std::size_t>(columns)), v(u);
    for (std::size_t j = begin; j < end; ++j) {
      predictor.row(static_cast<int>(j), u, v);
      std::size_t const at = j * static_cast<std::size_t>(columns);
      for (int i = 0; i < columns; ++i) {
        float const half_u = 0.5f * u[i], half_v = 0.5f * v[i];
        float const x = static_cast<float>(i), y = static_cast<float>(j);
        pair.reference[at + i] = reference.sample<degree>(i, static_cast<int>(j), -half_u, -half_v);
        pair.flow[at + i] = flow.sample<degree>(i, static_cast<int>(j), half_u, half_v);
        pair.available[at + i] = std::min(known(x - half_u, y - half_v), known(x + half_u, y + half_v));
      }
    }
  });
}

}  // namespace

ImagePair make_image_pair(Image<double> const& reference, Image<double> const& flow) {
  GLADSTONE_EXPECTS(!reference.empty() && reference.columns() == flow.columns() && reference.rows() == flow.rows());
  ImagePair pair;
  pair.columns = reference.columns();
  pair.rows = reference.rows();
  // the level between the extremes, taken off in double, keeps faint contrast on a bright ground in float
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool gaps = false;
  for (Image<double> const* image : {&reference, &flow})
    for (double const value : *image) {
      if (!std::isfinite(value)) {
        gaps = true;
        continue;
      }
      low = std::min(low, value);
      high = std::max(high, value);
    }
  double const level = low <= high ? 0.5 * (low + high) : 0.0;
  pair.contrast = low <= high ? static_cast<float>(high - low) : 0.0f;
  auto const take = [&](Image<double> const& image, std::vector<float>& out) {
    out.resize(image.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = std::isfinite(image.data()[i]) ? static_cast<float>(image.data()[i] - level) : 0.0f;
  };
  take(reference, pair.reference);
  take(flow, pair.flow);
  if (gaps) {
    pair.available.resize(reference.size());
    for (std::size_t i = 0; i < reference.size(); ++i)
      pair.available[i] = std::isfinite(reference.data()[i]) && std::isfinite(flow.data()[i]) ? 1.0f : 0.0f;
  }
  return pair;
}

DensePredictor::DensePredictor(InterrogationGrid const& grid, std::span<Vec2d const> nodes, int image_columns,
                               int image_rows)
    : grid_(grid) {
  GLADSTONE_EXPECTS(grid.size() > 0 && nodes.size() == grid.size());
  // ghost nodes reach past the image on all sides; their slope is taken over half a window, not over noise
  double const beyond = std::max(
      {grid.centre(0), image_columns - grid.centre(grid.columns - 1), image_rows - grid.centre(grid.rows - 1)});
  ghosts_ = static_cast<int>(std::ceil(beyond / grid.spacing_px)) + 2;
  columns_ = grid.columns + 2 * ghosts_;
  int const rows = grid.rows + 2 * ghosts_;
  nodes_.resize(static_cast<std::size_t>(columns_) * rows);
  auto const extended = [&](int k, int count, auto const& value) {
    int const base = std::min(count - 1, std::max(1, grid.window_px / (2 * grid.spacing_px)));
    if (k >= 0 && k < count) return value(k);
    int const edge = k < 0 ? 0 : count - 1;
    if (base < 1) return value(edge);
    int const inner = k < 0 ? base : count - 1 - base;
    int const steps = k < 0 ? -k : k - edge;
    return value(edge) + (static_cast<double>(steps) / base) * (value(edge) - value(inner));
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns_; ++i)
      nodes_[static_cast<std::size_t>(j) * columns_ + i] = extended(j - ghosts_, grid.rows, [&](int row) {
        return extended(i - ghosts_, grid.columns,
                        [&](int column) { return nodes[static_cast<std::size_t>(row) * grid.columns + column]; });
      });
  column_taps_.reserve(static_cast<std::size_t>(image_columns));
  for (int i = 0; i < image_columns; ++i) column_taps_.push_back(taps(i, columns_));
}

DensePredictor::Taps DensePredictor::taps(double position_px, int nodes) const {
  double const node = (position_px - grid_.centre(0)) / grid_.spacing_px + ghosts_;
  double const clamped = std::clamp(node, 1.0, static_cast<double>(nodes - 3));
  int const base = std::min(static_cast<int>(clamped), nodes - 3);
  Taps result{base - 1, {}};
  cubic_convolution(clamped - base, result.weight);
  return result;
}

Vec2d DensePredictor::at(Vec2d position_px) const {
  int const rows = static_cast<int>(nodes_.size()) / columns_;
  Taps const x = taps(position_px.x, columns_), y = taps(position_px.y, rows);
  Vec2d sum;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += (y.weight[j] * x.weight[i]) * nodes_[static_cast<std::size_t>(y.first + j) * columns_ + x.first + i];
  return sum;
}

void DensePredictor::row(int image_row, std::span<float> u, std::span<float> v) const {
  Taps const y = taps(image_row, static_cast<int>(nodes_.size()) / columns_);
  std::vector<Vec2d> line(static_cast<std::size_t>(columns_));
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j < 4; ++j) line[i] += y.weight[j] * nodes_[static_cast<std::size_t>(y.first + j) * columns_ + i];
  for (std::size_t i = 0; i < column_taps_.size(); ++i) {
    Taps const& x = column_taps_[i];
    Vec2d sum;
    for (int k = 0; k < 4; ++k) sum += x.weight[k] * line[x.first + k];
    u[i] = static_cast<float>(sum.x);
    v[i] = static_cast<float>(sum.y);
  }
}

PairDeformer::PairDeformer(Image<double> const& reference, Image<double> const& flow, int degree)
    : degree_(degree),
      original_(make_image_pair(reference, flow)),
      reference_(
          original_.columns, original_.rows, degree,
          [&](int i, int j) { return original_.reference[static_cast<std::size_t>(j) * original_.columns + i]; }),
      flow_(original_.columns, original_.rows, degree,
            [&](int i, int j) { return original_.flow[static_cast<std::size_t>(j) * original_.columns + i]; }) {}

ImagePair PairDeformer::deform(DensePredictor const& predictor) const {
  ImagePair pair;
  pair.columns = original_.columns;
  pair.rows = original_.rows;
  pair.contrast = original_.contrast;
  pair.reference.resize(original_.reference.size());
  pair.flow.resize(pair.reference.size());
  pair.available.resize(pair.reference.size());
  if (degree_ == 3)
    deform_rows<3>(reference_.view(), flow_.view(), original_, predictor, pair);
  else
    deform_rows<5>(reference_.view(), flow_.view(), original_, predictor, pair);
  if (std::all_of(pair.available.begin(), pair.available.end(), [](float known) { return known == 1.0f; }))
    pair.available.clear();
  return pair;
}

}  // namespace gladstone
