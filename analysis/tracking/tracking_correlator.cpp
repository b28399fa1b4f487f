#include "analysis/tracking/tracking_correlator.h"

#include <cstddef>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/pair_assessment.h"
#include "analysis/tracking/dot_tracking.h"
#include "analysis/tracking/located_frames.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline tracking {
namespace {

constexpr Vec2d unknown{not_a_number, not_a_number};
// number of frames per pair: its two frames, the frame before and the frame after
constexpr std::size_t frames_per_pair = 4;

/// Converts the table [correlate.tracking] and the known dots to settings of track_dots().
/// @pre the words of the table are valid
TrackingSettings tracking_settings(CorrelationSettings const& correlate) {
  TrackingTable const& table = correlate.tracking;
  GLADSTONE_EXPECTS(table.polarity == "auto" || table.polarity == "bright" || table.polarity == "dark");
  GLADSTONE_EXPECTS(table.shape == "round" || table.shape == "elliptic");
  TrackingSettings settings;
  settings.dots.polarity = table.polarity == "auto"     ? DotPolarity::automatic
                           : table.polarity == "bright" ? DotPolarity::bright
                                                        : DotPolarity::dark;
  settings.dots.shape = table.shape == "round" ? DotShape::round : DotShape::elliptic;
  settings.dots.diameter_px = table.diameter_px.value_or(0.0);
  settings.matching.search_radius_px = table.search_radius_px.value_or(0.0);
  if (table.displacement_bound_px) settings.matching.displacement_bound_px = *table.displacement_bound_px;
  settings.known_places_px = correlate.known_dots_px;
  return settings;
}

/// Returns the settings of the correlation that predicts the displacements.
CorrelationSettings predictor_settings(CorrelationSettings settings) {
  settings.method = "scc";
  settings.uncertainty = "none";
  settings.tracking = {};
  settings.known_dots_px.clear();
  return settings;
}

/// Invalidates the ambiguous vectors of a correlation.
DisplacementField certain_vectors(DisplacementField field) {
  for (std::size_t i = 0; i < field.size(); ++i)
    if (field.ambiguous[i] != Ambiguity::none && field.status[i] != VectorStatus::masked)
      field.status[i] = VectorStatus::invalid;
  return field;
}

/// Invalidates the vectors of frames that do not correlate. Vectors of dots are moved to the position of the dot in
/// frame A.
void invalidate(DisplacementField& field) {
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.status[i] == VectorStatus::masked) continue;
    if (field.columns == 0 && field.counts(i)) field.position_px[i] -= 0.5 * field.displacement_px[i];
    field.displacement_px[i] = field.sigma_px[i] = unknown;
    field.status[i] = VectorStatus::invalid;
    field.reason[i] = VectorReason::uncorrelated;
    field.failed[i] = FailedTest::none;
  }
}

class TrackingCorrelator final : public Correlator {
 public:
  explicit TrackingCorrelator(CorrelationSettings const& settings)
      : predictor_settings_(predictor_settings(settings)),
        predictor_(make_correlator(predictor_settings_)),
        tracking_(tracking_settings(settings)),
        located_(tracking_.dots, static_cast<std::size_t>(thread_count()) + frames_per_pair),
        on_grid_(settings.tracking.output == "grid") {}

  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    return correlate_pair(HostFrames(reference, flow));
  }

  DisplacementField correlate_pair(StoredFrames const& frames) const override {
    DisplacementField predictor = predictor_->correlate_pair(frames);
    assess_pair(predictor, frames, *predictor_, predictor_settings_);
    DisplacementField dots = track(frames, certain_vectors(predictor));
    DisplacementField field = on_grid_ ? interpolate_to_grid(predictor, dots) : dots;
    field.verdict = predictor.verdict;
    field.warnings.clear();
    for (Warning const& warning : predictor.warnings)
      field.warnings.push_back(at_place("correlation that predicts the displacements of dots", warning));
    field.warnings.insert(field.warnings.end(), dots.warnings.begin(), dots.warnings.end());
    if (!frames_correlate(predictor)) {
      invalidate(field);
      invalidate(dots);
    }
    auto const* const of_sequence = dynamic_cast<TrackFrames const*>(&frames);
    if (of_sequence && of_sequence->dots()) *of_sequence->dots() = std::move(dots);
    return field;
  }

 private:
  DisplacementField track(StoredFrames const& frames, DisplacementField const& predictor) const {
    auto const* const of_sequence = dynamic_cast<TrackFrames const*>(&frames);
    return of_sequence ? track_dots(*of_sequence, predictor, tracking_, located_)
                       : track_dots(frames.reference(), frames.flow(), predictor, tracking_);
  }

  /// Interpolates the vectors of the dots to the grid of the predictor.
  static DisplacementField interpolate_to_grid(DisplacementField const& predictor, DisplacementField const& dots) {
    DisplacementField field = interpolate_vectors(dots, predictor.position_px);
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (predictor.status[i] != VectorStatus::masked) continue;
      field.status[i] = VectorStatus::masked;
      field.reason[i] = VectorReason::masked;
      field.displacement_px[i] = field.sigma_px[i] = unknown;
    }
    field.columns = predictor.columns;
    field.rows = predictor.rows;
    field.raw_px = field.displacement_px;
    field.peak_ratio.assign(field.size(), not_a_number);
    field.correlation.assign(field.size(), not_a_number);
    field.failed.assign(field.size(), FailedTest::none);
    field.ambiguous.assign(field.size(), Ambiguity::none);
    return field;
  }

  CorrelationSettings predictor_settings_;
  std::unique_ptr<Correlator> predictor_;
  TrackingSettings tracking_;
  LocatedFrames located_;
  bool on_grid_;
};

}  // namespace

std::unique_ptr<Correlator> make_tracking_correlator(CorrelationSettings const& settings) {
  return std::make_unique<TrackingCorrelator>(settings);
}

std::unique_ptr<Correlator> make_cpu_correlator(CorrelationSettings const& settings) {
  return correlation_method(settings.method).tracks_dots ? make_tracking_correlator(settings)
                                                         : make_correlator(settings);
}

}  // namespace gladstone::inline tracking
