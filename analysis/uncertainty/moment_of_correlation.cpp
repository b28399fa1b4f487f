#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/correlation/methods/rpc.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/uncertainty/particle_pairs.h"

namespace gladstone::inline uncertainty {
namespace {

/// Empirical factor, fitted to the errors of the default passes for dots of 3 px at 5 % noise. Bhattacharya et al. use
/// the mutual information instead of the number of dots, and fit both to synthetic images.
constexpr double calibration = 0.22;
/// Lower bound of the displacement variance [px^2]: in noise-free images, peaks are as narrow as the filter, or even
/// narrower because of rounding.
constexpr double least_variance = 1e-4;

/// Returns the variance of the Gaussian through three samples, at most 16 px^2; NaN if a sample is not positive.
double variance_of_peak(double before, double centre, double after) {
  if (!(before > 0.0 && after > 0.0 && centre > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  double const curvature = 2.0 * std::log(centre) - std::log(before) - std::log(after);
  return curvature > 1.0 / 16.0 ? 1.0 / curvature : 16.0;
}

}  // namespace

std::vector<Vec2d> moment_of_correlation(UncertaintyInput const& input) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const of_filter = robust_phase_diameter_px * robust_phase_diameter_px / 8.0;
  std::vector<double> u(input.field.size(), nan), v = u;
  // The residual displacement of matched frames is small, so that the peak is the highest value near shift 0.
  InterrogationJob const job{input.matched, input.grid, window_weighting(input.settings), 2, fit_gauss3, "uncertainty"};
  visit_planes(job, {make_robust_phase_plane}, [&] {
    return [&](std::size_t first, int count, LaneCorrelation&, LanePlane& plane) {
      for (int lane = 0; lane < count; ++lane) {
        LanePlaneView const view{plane, lane};
        int x = 0, y = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            if (view(dx, dy) > view(x, y)) {
              x = dx;
              y = dy;
            }
        std::size_t const i = first + static_cast<std::size_t>(lane);
        u[i] = std::max(least_variance, variance_of_peak(view(x - 1, y), view(x, y), view(x + 1, y)) - of_filter);
        v[i] = std::max(least_variance, variance_of_peak(view(x, y - 1), view(x, y), view(x, y + 1)) - of_filter);
      }
    };
  });
  visit_matched_windows(input, [&](std::size_t i, MatchedWindow const& window) {
    thread_local std::vector<ParticleImagePair> pairs;
    find_particle_pairs(window, pairs);
    double const number = std::max(1.0, effective_number(pairs));
    u[i] *= calibration * calibration / number;
    v[i] *= calibration * calibration / number;
  });
  std::vector<Vec2d> sigma(u.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = {std::sqrt(u[i]), std::sqrt(v[i])};
  return sigma;
}

}  // namespace gladstone::inline uncertainty
