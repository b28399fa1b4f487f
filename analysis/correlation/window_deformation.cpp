#include "analysis/correlation/window_deformation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "analysis/correlation/lane_deformation.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t rows_per_chunk = 8;
constexpr std::size_t pixels_per_chunk = std::size_t{1} << 16;

/// Range of the finite grey levels of an image.
struct GreyLevels {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool gaps = false;  ///< true if some levels are not finite

  void include(GreyLevels const& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
    gaps = gaps || other.gaps;
  }
  /// Writes (value - level) * scale for each value and extends the range by the values.
  void take(double const* values, std::size_t count, double level, double scale, float* out) {
    constexpr std::size_t lanes = 16;
    double least[lanes], most[lanes], zero[lanes] = {};
    std::fill_n(least, lanes, low);
    std::fill_n(most, lanes, high);
    auto const look = [&](double value, std::size_t l) {
      least[l] = value < least[l] ? value : least[l];
      most[l] = value > most[l] ? value : most[l];
      zero[l] += value - value;  // NaN if any value is not finite
    };
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t l = 0; l < lanes; ++l) {
        out[i + l] = static_cast<float>((values[i + l] - level) * scale);
        look(values[i + l], l);
      }
    for (; i < count; ++i) {
      out[i] = static_cast<float>((values[i] - level) * scale);
      look(values[i], 0);
    }
    GreyLevels seen;
    for (std::size_t l = 0; l < lanes; ++l) seen.include({least[l], most[l], !(zero[l] == 0.0)});
    if (seen.gaps) {  // The extremes may be infinite: repeat the search with the finite values only.
      seen = {.gaps = true};
      for (i = 0; i < count; ++i)
        if (std::isfinite(values[i])) seen.include({values[i], values[i]});
    }
    include(seen);
  }
};

/// Returns the range of about 4096 evenly spaced pixels of each frame.
GreyLevels some_levels(Image<double> const& reference, Image<double> const& flow) {
  std::size_t const step =
      std::max<std::size_t>(1, reference.size() / 4096) | 1;  // odd, so that samples are not always in the same columns
  GreyLevels some;
  for (std::size_t i = 0; i < reference.size(); i += step)
    for (double const value : {reference.data()[i], flow.data()[i]})
      if (std::isfinite(value)) some.include({value, value, false});
  return some;
}

/// Returns the power of two that scales a range of levels to 1 .. 2; 1 if the range is zero or not finite.
double scale_of(double range) {
  bool const any = range > 0.0 && std::isfinite(range);
  return any ? std::ldexp(1.0, std::clamp(-std::ilogb(range), -1000, 1000)) : 1.0;
}

/// Replaces non-finite pixels by a level, and marks the pixels that are known in both frames.
void fill_gaps(ImagePair& pair, Image<double> const& reference, Image<double> const& flow, float level) {
  pair.available.resize(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    bool const in_reference = std::isfinite(reference.data()[i]), in_flow = std::isfinite(flow.data()[i]);
    if (!in_reference) pair.reference[i] = level;
    if (!in_flow) pair.flow[i] = level;
    pair.available[i] = in_reference && in_flow ? 1.0f : 0.0f;
  }
}

}  // namespace

ImagePair make_image_pair(Image<double> const& reference, Image<double> const& flow) {
  GLADSTONE_EXPECTS(!reference.empty() && reference.columns() == flow.columns() && reference.rows() == flow.rows());
  ImagePair pair;
  pair.columns = reference.columns();
  pair.rows = reference.rows();
  // Subtracting a mid-range level in double preserves faint contrast on a bright background in float. Scaling by a
  // power of two, which is exact, brings the contrast near 1, so that products of four levels do not overflow, and
  // energies and weights, which are transformed together, have similar magnitudes. Both values are estimated from a
  // sample of pixels; the full range may be up to a hundred times larger.
  GreyLevels const some = some_levels(reference, flow);
  bool const any = some.low <= some.high;
  double const level = any ? 0.5 * (some.low + some.high) : 0.0;
  pair.reference.resize(reference.size());
  pair.flow.resize(reference.size());
  std::vector<GreyLevels> levels((reference.size() + pixels_per_chunk - 1) / pixels_per_chunk);
  GreyLevels all;
  auto const take_all = [&](double scale) {
    parallel_chunks(reference.size(), pixels_per_chunk, [&](std::size_t begin, std::size_t end) {
      GreyLevels here;
      here.take(reference.data() + begin, end - begin, level, scale, pair.reference.data() + begin);
      here.take(flow.data() + begin, end - begin, level, scale, pair.flow.data() + begin);
      levels[begin / pixels_per_chunk] = here;
    });
    all = {};
    for (GreyLevels const& piece : levels) all.include(piece);
    return scale;
  };
  constexpr double most_beyond = 100.0;
  double scale = take_all(any ? scale_of(some.high - some.low) : 1.0);
  double const range = all.low <= all.high ? all.high - all.low : 0.0;
  if (!(range * scale <= 2.0 * most_beyond) || (range > 0.0 && range * scale < 1.0)) scale = take_all(scale_of(range));
  pair.contrast = static_cast<float>(range * scale);
  // grey level in the middle of the full range, after subtraction of `level` and multiplication by `scale`
  float const middle = range > 0.0 ? static_cast<float>((0.5 * (all.low + all.high) - level) * scale) : 0.0f;
  if (all.gaps) fill_gaps(pair, reference, flow, middle);
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
      nodes_[static_cast<std::size_t>(j) * columns_ + i] = extended_node(
          grid, [&](int k) { return nodes[k]; }, i - ghosts_, j - ghosts_);
  for (int i = 0; i < image_columns; ++i) {
    PredictorView::Taps const x = view().taps(GridAxis::x, i);
    column_first_.push_back(x.first);
    for (int k = 0; k < 4; ++k) column_weights_[k].push_back(static_cast<float>(x.weight[k]));
  }
}

void DensePredictor::row(int image_row, std::span<float> u, std::span<float> v) const {
  PredictorView::Taps const y = view().taps(GridAxis::y, image_row);
  std::vector<float> line_u(static_cast<std::size_t>(columns_)), line_v(line_u);
  for (int i = 0; i < columns_; ++i) {
    Vec2d sum;
    for (int j = 0; j < 4; ++j) sum += y.weight[j] * nodes_[static_cast<std::size_t>(y.first + j) * columns_ + i];
    line_u[i] = static_cast<float>(sum.x);
    line_v[i] = static_cast<float>(sum.y);
  }
  // All pixels between two nodes use the same four nodes.
  std::size_t const all = column_first_.size();
  for (std::size_t begin = 0, end = 0; begin < all; begin = end) {
    int const first = column_first_[begin];
    while (end < all && column_first_[end] == first) ++end;
    float const *const a = line_u.data() + first, *const b = line_v.data() + first;
    for (std::size_t i = begin; i < end; ++i) {
      float const w0 = column_weights_[0][i], w1 = column_weights_[1][i];
      float const w2 = column_weights_[2][i], w3 = column_weights_[3][i];
      u[i] = w0 * a[0] + w1 * a[1] + w2 * a[2] + w3 * a[3];
      v[i] = w0 * b[0] + w1 * b[1] + w2 * b[2] + w3 * b[3];
    }
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
  deform(predictor, pair);
  return pair;
}

void PairDeformer::deform(DensePredictor const& predictor, ImagePair& pair) const {
  pair.columns = original_.columns;
  pair.rows = original_.rows;
  pair.contrast = original_.contrast;
  pair.reference.resize(original_.reference.size());
  pair.flow.resize(pair.reference.size());
  pair.available.resize(pair.reference.size());
  LaneDeformation const deformation{reference_.view(), flow_.view(), original_.available};
  std::atomic<bool> all_known{true};
  parallel_chunks(static_cast<std::size_t>(pair.rows), rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<float> u(static_cast<std::size_t>(pair.columns)), v(u);
    for (std::size_t j = begin; j < end; ++j) {
      predictor.row(static_cast<int>(j), u, v);
      std::size_t const at = j * static_cast<std::size_t>(pair.columns);
      deformation.row(degree_, static_cast<int>(j), u, v,
                      {pair.reference.data() + at, pair.flow.data() + at, pair.available.data() + at});
    }
    auto const known = pair.available.begin() + static_cast<std::ptrdiff_t>(begin) * pair.columns;
    if (!std::all_of(known, known + static_cast<std::ptrdiff_t>(end - begin) * pair.columns,
                     [](float here) { return here == 1.0f; }))
      all_known = false;
  });
  if (all_known) pair.available.clear();
}

}  // namespace gladstone::inline correlation
