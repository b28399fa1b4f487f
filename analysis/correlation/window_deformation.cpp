#include "analysis/correlation/window_deformation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr std::size_t rows_per_chunk = 8;

template <int degree>
void deform_rows(BsplineView<float> reference, BsplineView<float> flow, ImagePair const& original,
                 DensePredictor const& predictor, ImagePair& pair) {
  int const columns = pair.columns, rows = pair.rows;
  auto const known = [&](int i, int j) {
    return original.available.empty() ? 1.0f : original.available[static_cast<std::size_t>(j) * columns + i];
  };
  parallel_chunks(static_cast<std::size_t>(rows), rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<float> u(static_cast<std::size_t>(columns)), v(u);
    for (std::size_t j = begin; j < end; ++j) {
      predictor.row(static_cast<int>(j), u, v);
      std::size_t const at = j * static_cast<std::size_t>(columns);
      for (int i = 0; i < columns; ++i) {
        DeformedPixel const pixel = deformed_pixel<degree>(reference, flow, i, static_cast<int>(j), u[i], v[i], known);
        pair.reference[at + i] = pixel.reference;
        pair.flow[at + i] = pixel.flow;
        pair.available[at + i] = pixel.available;
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
  ghosts_ = ghost_nodes(grid, image_columns, image_rows);
  columns_ = grid.columns + 2 * ghosts_;
  rows_ = grid.rows + 2 * ghosts_;
  nodes_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (int j = 0; j < rows_; ++j)
    for (int i = 0; i < columns_; ++i)
      nodes_[static_cast<std::size_t>(j) * columns_ + i] = extended_node(grid, nodes.data(), i - ghosts_, j - ghosts_);
  column_taps_.reserve(static_cast<std::size_t>(image_columns));
  for (int i = 0; i < image_columns; ++i) column_taps_.push_back(view().taps(i, columns_));
}

void DensePredictor::row(int image_row, std::span<float> u, std::span<float> v) const {
  PredictorView::Taps const y = view().taps(image_row, rows_);
  std::vector<Vec2d> line(static_cast<std::size_t>(columns_));
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j < 4; ++j) line[i] += y.weight[j] * nodes_[static_cast<std::size_t>(y.first + j) * columns_ + i];
  for (std::size_t i = 0; i < column_taps_.size(); ++i) {
    PredictorView::Taps const& x = column_taps_[i];
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
