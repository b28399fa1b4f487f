#include "analysis/correlation/lane_deformation.h"

#include "analysis/correlation/float_lanes.h"
#include "analysis/correlation/window_deformation.h"

namespace gladstone::inline correlation {
namespace {

/// Eight adjacent positions in a row, (column + l + dx, row + dy) for lane l, split into pixel and offset as in
/// BsplineView::sample().
template <int degree>
struct LanePositions {
  int column, row;
  FloatLanes dx, dy;
  IntLanes whole_x, whole_y;
  FloatLanes weight_x[degree + 1], weight_y[degree + 1];

  LanePositions(int first, int j, FloatLanes x, FloatLanes y)
      : column(first), row(j), dx(x), dy(y), whole_x(floor_lanes(x)), whole_y(floor_lanes(y)) {
    interpolation_weights<degree, FloatLanes, float>(dx - __builtin_convertvector(whole_x, FloatLanes), weight_x);
    interpolation_weights<degree, FloatLanes, float>(dy - __builtin_convertvector(whole_y, FloatLanes), weight_y);
  }

  /// Evaluates the spline in all lanes, assuming that they share the same integer displacement.
  /// @tparam opposite true: evaluates at (column + l - dx, row - dy), where the weights are the same in reverse order,
  ///         because a position at t after a node is replaced by one at 1 - t after the preceding node
  template <bool opposite>
  FloatLanes sum(BsplineView<float> const& image, int base_x, int base_y) const {
    using View = BsplineView<float>;
    constexpr int before = (degree - 1) / 2;
    auto const place = [](int k) { return opposite ? degree - k : k; };
    float const* c = image.coefficients + static_cast<long long>(base_y - before + View::margin_before) * image.stride +
                     (base_x - before + View::margin_before);
    FloatLanes all{};
    for (int j = 0; j <= degree; ++j, c += image.stride) {
      FloatLanes line = weight_x[place(0)] * load_lanes(c);
      for (int i = 1; i <= degree; ++i) line += weight_x[place(i)] * load_lanes(c + i);
      all += weight_y[place(j)] * line;
    }
    return all;
  }

  template <bool opposite>
  FloatLanes sample(BsplineView<float> const& image) const {
    float const sign = opposite ? -1.0f : 1.0f;
    FloatLanes result{};
    for (unsigned left = (1u << lane_count) - 1u; left != 0;) {
      int const lane = __builtin_ctz(left), x = whole_x[lane], y = whole_y[lane];
      int const base_x = column + (opposite ? -1 - x : x);
      IntLanes const alike = (whole_x == x) & (whole_y == y);
      unsigned const bits = bits_of_lanes(alike);
      if (base_x >= -1 && base_x + lane_count <= image.columns) {
        int const base_y = BsplineView<float>::clamp(row + (opposite ? -1 - y : y), image.rows);
        result = select_lanes(alike, sum<opposite>(image, base_x, base_y), result);
      } else {
        for (int l = 0; l < lane_count; ++l)
          if ((bits >> l & 1u) != 0u) result[l] = image.sample<degree>(column + l, row, sign * dx[l], sign * dy[l]);
      }
      left &= ~bits;
    }
    return result;
  }
};

/// Returns 1 for positions inside an image, otherwise 0.
FloatLanes inside_lanes(BsplineView<float> const& image, FloatLanes x, FloatLanes y) {
  float const right = static_cast<float>(image.columns) - 0.5f, bottom = static_cast<float>(image.rows) - 0.5f;
  return select_lanes((x >= -0.5f) & (x <= right) & (y >= -0.5f) & (y <= bottom), all_lanes(1.0f), FloatLanes{});
}

template <int degree>
void deform_row(LaneDeformation const& pair, int j, std::span<float const> u, std::span<float const> v,
                DeformedRow const& out) {
  constexpr FloatLanes count_up{0, 1, 2, 3, 4, 5, 6, 7};
  int const columns = pair.reference.columns, rows = pair.reference.rows;
  auto const known = [&](int i, int row) {
    return pair.available.empty() ? 1.0f : pair.available[static_cast<std::size_t>(row) * columns + i];
  };
  int i = 0;
  for (; i + lane_count <= columns; i += lane_count) {
    FloatLanes const half_u = 0.5f * load_lanes(u.data() + i), half_v = 0.5f * load_lanes(v.data() + i);
    LanePositions<degree> const positions(i, j, half_u, half_v);
    store_lanes(out.flow + i, positions.template sample<false>(pair.flow));
    store_lanes(out.reference + i, positions.template sample<true>(pair.reference));
    FloatLanes const x = count_up + static_cast<float>(i), y = all_lanes(static_cast<float>(j));
    FloatLanes here =
        inside_lanes(pair.reference, x - half_u, y - half_v) * inside_lanes(pair.flow, x + half_u, y + half_v);
    for (int l = 0; l < lane_count && !pair.available.empty(); ++l)
      here[l] = known_at(x[l] - half_u[l], y[l] - half_v[l], columns, rows, known) *
                known_at(x[l] + half_u[l], y[l] + half_v[l], columns, rows, known);
    store_lanes(out.available + i, here);
  }
  for (; i < columns; ++i) {
    DeformedPixel const pixel = deformed_pixel<degree>(pair.reference, pair.flow, i, j, u[i], v[i], known);
    out.reference[i] = pixel.reference;
    out.flow[i] = pixel.flow;
    out.available[i] = pixel.available;
  }
}

}  // namespace

void LaneDeformation::row(int degree, int j, std::span<float const> u, std::span<float const> v,
                          DeformedRow const& out) const {
  if (degree == 3)
    deform_row<3>(*this, j, u, v, out);
  else if (degree == windowed_sinc)
    deform_row<windowed_sinc>(*this, j, u, v, out);
  else
    deform_row<5>(*this, j, u, v, out);
}

}  // namespace gladstone::inline correlation
