#pragma once

#include <cmath>
#include <vector>

#include "render/sensor/diffraction_spot.h"

/// Fast summation of many rays with the same Gaussian PSF, for CPU and GPU: hits are distributed over the nodes of a
/// fine grid with cubic B-spline weights, and the grid is convolved once with PSF and pixel area.
///
/// The method interpolates the light of a hit on a pixel, as a function of the hit's position, by cubic splines. The
/// error is h^4/384 times the fourth derivative (de Boor, A Practical Guide to Splines), which is at most 1.4 /
/// sigma^4. With three nodes per sigma, the error per pixel is at most 5e-5 of a ray's light, a fifth of a grey level
/// at 12 bits, and less for pixels lit by rays at many positions.
namespace gladstone::inline rays {

/// The four nodes over which a hit is distributed along one axis, and their weights.
struct HitStencil {
  int first;
  double share[4];

  /// @param u  position of the hit, in node spacings
  GLADSTONE_HD explicit HitStencil(double u) {
    using std::floor;
    double const whole = floor(u), t = u - whole, s = 1 - t;
    first = static_cast<int>(whole) - 1;
    share[0] = s * s * s / 6;
    share[1] = (4 - 6 * t * t + 3 * t * t * t) / 6;
    share[2] = (4 - 6 * s * s + 3 * s * s * s) / 6;
    share[3] = t * t * t / 6;
  }
};

/// Range of nodes along one axis. Node 0 is at the centre of pixel 0.
struct NodeRange {
  int low, high;  ///< first node, and one past the last one
};

/// Light of a node on the pixels along one axis: a non-owning view.
struct HitSplineView {
  double const* share = nullptr;  ///< weights by node position from the pixel centre, -reach() to reach()
  int per_px = 1;                 ///< nodes per pixel
  int reach_px = 0;               ///< distance to the farthest pixel that a node illuminates, plus one [px]

  GLADSTONE_HD int reach() const { return reach_px * per_px; }
  GLADSTONE_HD int count() const { return 2 * reach() + 1; }
  /// Returns the first pixel that a range of nodes illuminates; pixels() is the number of illuminated pixels.
  /// @pre nodes.low >= 0
  GLADSTONE_HD int first_pixel(NodeRange nodes) const { return nodes.low / per_px - reach_px; }
  GLADSTONE_HD int pixels(NodeRange nodes) const {
    return (nodes.high - 1) / per_px + reach_px + 1 - first_pixel(nodes);
  }
  /// Returns the light on a pixel from a range of nodes.
  /// @param light  values of all nodes, from node 0 on
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

/// Group of cooperating threads: a single one on the CPU.
struct SingleThread {
  int rank() const { return 0; }
  int size() const { return 1; }
  void sync() const {}
};

/// Convolves the light of a square of nodes with PSF and pixel area, first along rows, then along columns.
/// @param side  nodes along the square's side
/// @param rows_seen  work space: one number per line of nodes and pixel of a row
/// @param pixel  called once as (column, row, light) for every illuminated pixel
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

/// Owner of the weights of a HitSplineView.
class HitSpline {
 public:
  explicit HitSpline(GaussianSpot<double> const& spot);
  /// Returns true if a PSF of standard deviation sigma [px] is wide enough for at most 24 nodes per pixel.
  static bool serves(double sigma);
  HitSplineView view() const { return {share_.data(), per_px_, reach_px_}; }

 private:
  int per_px_, reach_px_;
  std::vector<double> share_;
};

}  // namespace gladstone::inline rays
