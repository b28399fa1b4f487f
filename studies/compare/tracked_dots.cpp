#include "studies/compare/tracked_dots.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/tracking/gaussian_window.h"
#include "render/base/median.h"

namespace gladstone::inline compare {
namespace {

constexpr double least_light = 0.1;  // minimum light of a dot, relative to the median

double median_of_positive(std::span<double const> values) {
  std::vector<double> positive;
  std::copy_if(values.begin(), values.end(), std::back_inserter(positive), [](double value) { return value > 0; });
  return upper_median(std::move(positive));
}

}  // namespace

CorrelationSettings with_known_dots(CorrelationSettings settings, Setup const& setup,
                                    std::vector<Vec2d> const& reference_px) {
  if (correlation_method(settings.method).tracks_dots && setup.experiment().sources.on_target)
    settings.known_dots_px = reference_px;
  return settings;
}

WindowTruth tracked_truth(GroundTruth const& dots, std::span<double const> flux, CameraSetup const& camera,
                          std::vector<Vec2d> const& point_truth, std::vector<Vec2d> const& position_px,
                          CorrelationSettings const& settings, TruthAt at) {
  WindowTruth truth;
  if (settings.gives_scattered_vectors()) {
    truth.displacement_px = point_truth;
    return truth;
  }
  auto const in_view = [&](Vec2d p) {
    return p.x > -0.5 && p.y > -0.5 && p.x < camera.columns - 0.5 && p.y < camera.rows - 0.5;
  };
  double const faintest = least_light * median_of_positive(flux);
  DisplacementField located;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    Vec2d const place = dots.reference_px[i], displacement = dots.displacement_px[i];
    if (!in_view(place) || !in_view(place + displacement) || !(flux[i] > faintest)) continue;
    located.position_px.push_back(at == TruthAt::mid_position ? place + 0.5 * displacement : place);
    located.displacement_px.push_back(displacement);
  }
  truth.displacement_px = tracking::interpolate_vectors(located, position_px).displacement_px;
  truth.left_out = static_cast<std::size_t>(std::count_if(truth.displacement_px.begin(), truth.displacement_px.end(),
                                                          [](Vec2d value) { return !is_finite(value); }));
  return truth;
}

}  // namespace gladstone::inline compare
