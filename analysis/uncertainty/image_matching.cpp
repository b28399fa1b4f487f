#include <cmath>
#include <limits>

#include "analysis/uncertainty/particle_pairs.h"
#include "analysis/uncertainty/pass_amplification.h"

namespace gladstone::inline uncertainty {
namespace {

/// Minimum degrees of freedom (dots minus one), averaged over a window and its neighbours, required for an estimate of
/// the scatter of the disparities.
constexpr double least_freedom = 0.25;

}  // namespace

std::vector<Vec2d> image_matching(UncertaintyInput const& input) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const amplification = amplification_of_passes(input.settings);
  std::vector<double> number(input.field.size(), nan), freedom = number, u = number, v = number;
  visit_matched_windows(input, [&](std::size_t i, MatchedWindow const& window) {
    thread_local std::vector<ParticleImagePair> pairs;
    find_particle_pairs(window, pairs);
    remove_mismatched_pairs(pairs);
    number[i] = effective_number(pairs);
    if (!(number[i] > 0.0)) return;
    double weights = 0.0;
    Vec2d squares;
    for (auto const& [disparity, weight] : pairs) {
      weights += weight;
      squares += weight * Vec2d{disparity.x * disparity.x, disparity.y * disparity.y};
    }
    // The frames were matched by the mean disparity, which leaves N - 1 degrees of freedom for N disparities.
    freedom[i] = number[i] - 1.0;
    u[i] = number[i] * squares.x / weights;
    v[i] = number[i] * squares.y / weights;
  });
  freedom = averaged_over_neighbours(freedom, input.grid);
  u = averaged_over_neighbours(u, input.grid);
  v = averaged_over_neighbours(v, input.grid);
  std::vector<Vec2d> sigma(u.size(), {nan, nan});
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    if (!(freedom[i] > least_freedom)) continue;
    sigma[i] = amplification / std::sqrt(freedom[i] * number[i]) * Vec2d{std::sqrt(u[i]), std::sqrt(v[i])};
  }
  return sigma;
}

}  // namespace gladstone::inline uncertainty
