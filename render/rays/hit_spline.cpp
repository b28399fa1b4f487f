#include "render/rays/hit_spline.h"

#include <algorithm>

namespace gladstone::inline rays {
namespace {

constexpr double nodes_a_sigma = 3;
constexpr int most_nodes_a_pixel = 24;

}  // namespace

bool HitSpline::serves(double sigma) { return sigma * most_nodes_a_pixel >= nodes_a_sigma; }

HitSpline::HitSpline(GaussianSpot<double> const& spot)
    : per_px_(std::max(2, static_cast<int>(std::ceil(nodes_a_sigma / spot.sigma)))), reach_px_(spot.half_width() + 2) {
  // Coefficients c of the spline that interpolates the light s of a pixel for hits at the nodes: (c[-1] + 4 c[0] +
  // c[1]) / 6 = s[0].
  int const reach = reach_px_ * per_px_, count = 2 * reach + 1;
  std::vector<double> upper(static_cast<std::size_t>(count));
  share_.resize(upper.size());
  for (int i = 0; i < count; ++i) {
    double const x = static_cast<double>(i - reach) / per_px_;
    auto const at = static_cast<std::size_t>(i);
    double const seen = GaussianSpot<double>::edge_value((x + 0.5) / spot.sigma) -
                        GaussianSpot<double>::edge_value((x - 0.5) / spot.sigma);
    double const before = i > 0 ? upper[at - 1] : 0, c_before = i > 0 ? share_[at - 1] : 0;
    upper[at] = 1 / (4 - before);
    share_[at] = (6 * seen - c_before) * upper[at];
  }
  for (int i = count - 2; i >= 0; --i) {
    share_[static_cast<std::size_t>(i)] -= upper[static_cast<std::size_t>(i)] * share_[static_cast<std::size_t>(i + 1)];
  }
}

}  // namespace gladstone::inline rays
