#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/uncertainty/particle_pairs.h"

namespace gladstone {
namespace {

/// Fewest dots whose scatter says something.
constexpr double fewest_dots = 3.0;
/// Maxima of noise pass for dots, faint ones scatter more than they count in the correlation, and the mean disparity is
/// counted besides the scatter that makes it; found on the seeds of docs/estimators.md.
constexpr double calibration = 0.74;
/// Distance of two images of one dot that three points leave where there is no noise, from neighbours' light and the
/// spline [px]; the correlation does not suffer from it, and its square is taken off.
constexpr double of_single_dots_px = 0.024;

}  // namespace

std::vector<Vec2d> image_matching(UncertaintyInput const& input) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> u(input.field.size(), nan), v = u;
  visit_matched_windows(input, [&](std::size_t i, MatchedWindow const& window) {
    thread_local std::vector<ParticleImagePair> pairs;
    find_particle_pairs(window, pairs);
    leave_out_mismatches(pairs);
    double const number = effective_number(pairs);
    if (number < fewest_dots) return;
    double weights = 0.0;
    Vec2d sum, squares;
    for (auto const& [disparity, weight] : pairs) {
      weights += weight;
      sum += weight * disparity;
      squares += weight * Vec2d{disparity.x * disparity.x, disparity.y * disparity.y};
    }
    Vec2d const mean = sum / weights;
    auto const variance = [&](double square, double middle) {
      double const scatter = square / weights - middle * middle;
      double const by_noise = std::max(0.1 * scatter, scatter - of_single_dots_px * of_single_dots_px);
      return middle * middle + by_noise / number;
    };
    u[i] = calibration * calibration * variance(squares.x, mean.x);
    v[i] = calibration * calibration * variance(squares.y, mean.y);
  });
  return sigma_of_variances(u, v, input.grid);
}

}  // namespace gladstone
