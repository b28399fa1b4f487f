#include "analysis/uncertainty/pass_amplification.h"

#include <cmath>
#include <vector>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/predictor_view.h"
#include "analysis/correlation/standard_correlator.h"
#include "render/base/units.h"

namespace gladstone::inline uncertainty {
namespace {

constexpr int frequencies = 96;
/// Highest frequency along an axis, in cycles per final window: at this frequency, the response of a Gaussian window is
/// below 1e-10.
constexpr double highest = 4.0;

/// Returns the frequency response of a window along one axis. @param f  frequency [1/px]
double window_response(WindowWeighting weighting, double f, double window_px) {
  double const phase = pi * f * window_px;
  if (weighting == WindowWeighting::gaussian) return std::exp(-0.5 * phase * phase / pi);
  return phase == 0.0 ? 1.0 : std::sin(phase) / phase;
}

/// Returns the frequency response of the predictor along one axis. @param f  frequency [1/node]
/// @param smoothing  smoothing weight, see CorrelationSchedule::smoothing()
double predictor_response(double f, double smoothing) {
  constexpr int steps = 64;
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    double const t = (k + 0.5) / steps;
    double weight[4];
    cubic_convolution(t, weight);
    for (int node = 0; node < 4; ++node) sum += weight[node] * std::cos(2.0 * pi * f * (node - 1 - t)) / steps;
  }
  return sum * (1.0 - smoothing * (1.0 - std::cos(2.0 * pi * f)));
}

}  // namespace

double amplification_of_passes(CorrelationSettings const& settings) {
  if (correlation_method(settings.method).optical_flow) return 1.0;
  CorrelationSchedule const schedule(settings);
  double const last_px = settings.window_px.back();
  std::vector<std::vector<double>> window, predictor;
  for (int pass = 0; pass < schedule.passes(); ++pass) {
    InterrogationGrid const grid = schedule.grid(pass, settings.window_px.front(), settings.window_px.front());
    window.emplace_back();
    predictor.emplace_back();
    for (int k = 0; k < frequencies; ++k) {
      double const f = highest * (k + 0.5) / frequencies / last_px;
      window.back().push_back(window_response(schedule.weighting(), f, grid.window_px));
      predictor.back().push_back(predictor_response(f * grid.spacing_px, schedule.smoothing(pass)));
    }
  }
  double all = 0.0, alone = 0.0;
  for (int j = 0; j < frequencies; ++j)
    for (int i = 0; i < frequencies; ++i) {
      double response = 0.0, h = 0.0;
      for (std::size_t pass = 0; pass < window.size(); ++pass) {
        h = window[pass][i] * window[pass][j];
        double const before = pass > 0 ? predictor[pass - 1][i] * predictor[pass - 1][j] * response : 0.0;
        response = h + (1.0 - h) * before;
      }
      all += response * response;
      alone += h * h;
    }
  return std::sqrt(all / alone);
}

}  // namespace gladstone::inline uncertainty
