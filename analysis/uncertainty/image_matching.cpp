#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/uncertainty/particle_pairs.h"

namespace gladstone {
namespace {

/// Fewest dots whose scatter says something.
constexpr double fewest_dots = 3.0;
/// Neighbouring dots share pixels, so that their disparities have errors in common and as many say less than if they
/// were independent, and maxima of noise pass for dots; found on the seeds of docs/estimators.md.
constexpr double calibration = 1.18;

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
      return middle * middle + scatter / number;
    };
    u[i] = calibration * calibration * variance(squares.x, mean.x);
    v[i] = calibration * calibration * variance(squares.y, mean.y);
  });
  return sigma_of_variances(u, v, input.grid);
}

}  // namespace gladstone
