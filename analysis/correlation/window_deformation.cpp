#include "analysis/correlation/window_deformation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr std::size_t rows_per_chunk = 8;
constexpr std::size_t pixels_per_chunk = std::size_t{1} << 16;

/// The extremes of finite grey levels.
struct GreyLevels {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool gaps = false;  ///< whether some are not finite

  void include(GreyLevels const& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
    gaps = gaps || other.gaps;
  }
  /// Takes `level` off the values and looks at them on the way.
  void take(double const* values, std::size_t count, double level, float* out) {
    constexpr std::size_t lanes = 8;
    double least[lanes], most[lanes], zero[lanes] = {};
    std::fill_n(least, lanes, low);
    std::fill_n(most, lanes, high);
    auto const look = [&](double value, std::size_t l) {
      double const gap = value - value;  // 0, or NaN where it is not finite
      bool const finite = gap == 0.0;
      zero[l] += gap;
      least[l] = finite && value < least[l] ? value : least[l];
      most[l] = finite && value > most[l] ? value : most[l];
    };
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t l = 0; l < lanes; ++l) {
        out[i + l] = static_cast<float>(values[i + l] - level);
        look(values[i + l], l);
      }
    for (; i < count; ++i) {
      out[i] = static_cast<float>(values[i] - level);
      look(values[i], 0);
    }
    for (std::size_t l = 0; l < lanes; ++l) include({least[l], most[l], !(zero[l] == 0.0)});
  }
};

/// The middle of the extremes of some thousand finite grey levels, evenly taken; 0 where there are none.
double middle_level(Image<double> const& reference, Image<double> const& flow) {
  std::size_t const step = std::max<std::size_t>(1, reference.size() / 4096) | 1;  // odd: not always the same column
  GreyLevels some;
  for (std::size_t i = 0; i < reference.size(); i += step)
    for (double const value : {reference.data()[i], flow.data()[i]})
      if (std::isfinite(value)) some.include({value, value, false});
  return some.low <= some.high ? 0.5 * (some.low + some.high) : 0.0;
}

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
  // a level between the extremes, taken off in double, keeps faint contrast on a bright ground in float
  double const level = middle_level(reference, flow);
  pair.reference.resize(reference.size());
  pair.flow.resize(reference.size());
  std::vector<GreyLevels> levels((reference.size() + pixels_per_chunk - 1) / pixels_per_chunk);
  parallel_chunks(reference.size(), pixels_per_chunk, [&](std::size_t begin, std::size_t end) {
    GreyLevels here;
    here.take(reference.data() + begin, end - begin, level, pair.reference.data() + begin);
    here.take(flow.data() + begin, end - begin, level, pair.flow.data() + begin);
    levels[begin / pixels_per_chunk] = here;
  });
  GreyLevels all;
  for (GreyLevels const& piece : levels) all.include(piece);
  pair.contrast = all.low <= all.high ? static_cast<float>(all.high - all.low) : 0.0f;
  if (!all.gaps) return pair;
  // unknown pixels take the middle of all, whichever level was taken off
  float const middle = all.low <= all.high ? static_cast<float>(0.5 * (all.low + all.high) - level) : 0.0f;
  pair.available.resize(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    bool const in_reference = std::isfinite(reference.data()[i]), in_flow = std::isfinite(flow.data()[i]);
    if (!in_reference) pair.reference[i] = middle;
    if (!in_flow) pair.flow[i] = middle;
    pair.available[i] = in_reference && in_flow ? 1.0f : 0.0f;
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
