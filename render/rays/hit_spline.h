#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/sensor/diffraction_spot.h"

/// Light of many rays with one Gaussian spot, on every device: hits are dealt to the nodes of a fine grid by cubic
/// B-spline weights, and the grid is blurred once by spot and pixels.
///
/// What a pixel sees of a hit, as a function of its place, is interpolated by the splines that the hits are dealt to:
/// to h^4/384 of its fourth derivative (de Boor, A Practical Guide to Splines), 1.4 over sigma^4. Three nodes a sigma
/// leave 5e-5 of a ray's light to a pixel at worst, a fifth of a grey level of 12 bits, and less of any pixel that rays
/// at many places light.
namespace gladstone {

/// The nodes that a hit is dealt to along one axis, and their shares of it.
struct DealtHit {
  int first;
  double share[4];

  /// @param u the hit's place in nodes
  GLADSTONE_HD explicit DealtHit(double u) {
    using std::floor;
    double const whole = floor(u), t = u - whole, s = 1 - t;
    first = static_cast<int>(whole) - 1;
    share[0] = s * s * s / 6;
    share[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    share[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    share[3] = t * t * t / 6;
  }
};

/// A range of nodes along one axis; node 0 lies in the middle of pixel 0.
struct NodeRange {
  int low, high;  ///< [low, high)
};

/// What pixels see of light at the nodes, along one axis.
struct HitSplineView {
  double const* share = nullptr;  ///< by the node's place from the pixel's middle, from -reach() to reach()
  int per_px = 1;                 ///< nodes a pixel
  int reach_px = 0;               ///< furthest pixel that a node lights, and one more

  GLADSTONE_HD int reach() const { return reach_px * per_px; }
  GLADSTONE_HD int count() const { return 2 * reach() + 1; }
  /// Pixels that a range of nodes lights. @pre nodes.low >= 0
  GLADSTONE_HD int first_pixel(NodeRange nodes) const { return nodes.low / per_px - reach_px; }
  GLADSTONE_HD int pixels(NodeRange nodes) const {
    return (nodes.high - 1) / per_px + reach_px + 1 - first_pixel(nodes);
  }
  /// What a pixel sees of the light of a range of nodes, of which the first value is node 0's.
  template <class Light>
  GLADSTONE_HD double seen(int pixel, NodeRange nodes, Light const* light, int stride) const {
    int const middle = pixel * per_px;
    int const from = nodes.low > middle - reach() ? nodes.low : middle - reach();
    int const to = nodes.high < middle + reach() + 1 ? nodes.high : middle + reach() + 1;
    int const first = reach() - middle;
    double sum = 0;
    for (int node = from; node < to; ++node) sum += share[first + node] * static_cast<double>(light[node * stride]);
    return sum;
  }
};

/// Threads that do one thing together; on the CPU it is one.
struct OneLane {
  int rank() const { return 0; }
  int size() const { return 1; }
  void sync() const {}
};

/// Blurs the light of a square of nodes by the spot and the pixels: along rows, then along columns.
/// @param side of the square, in nodes @param rows_seen room for a number for every line of the square and pixel of a
/// row
/// @param pixel called as (column, row, light) once for every pixel that they light
template <class Group, class Light, class Pixel>
GLADSTONE_HD void blur_hits(Group const& group, HitSplineView const& spline, NodeRange columns, NodeRange lines,
                            Light const* light, int side, double* rows_seen, Pixel&& pixel) {
  int const left = spline.first_pixel(columns), top = spline.first_pixel(lines);
  int const wide = spline.pixels(columns), tall = spline.pixels(lines), line_count = lines.high - lines.low;
  for (int k = group.rank(); k < line_count * wide; k += group.size()) {
    int const line = lines.low + k / wide;
    rows_seen[line * wide + k % wide] = spline.seen(left + k % wide, columns, light + line * side, 1);
  }
  group.sync();
  for (int k = group.rank(); k < tall * wide; k += group.size()) {
    int const column = k % wide, row = top + k / wide;
    pixel(left + column, row, spline.seen(row, lines, rows_seen + column, wide));
  }
}

/// Owner of what a view shows.
class HitSpline {
 public:
  explicit HitSpline(GaussianSpot<double> const& spot);
  /// Whether so wide a spot [px] needs no more nodes than a grid of sensible size has.
  static bool serves(double sigma);
  HitSplineView view() const { return {share_.data(), per_px_, reach_px_}; }

 private:
  int per_px_, reach_px_;
  std::vector<double> share_;
};

}  // namespace gladstone
