#include "analysis/tracking/tracking_correlator.h"

#include "render/base/not_a_number.h"

namespace gladstone::tracking {
namespace {

class TrackingCorrelator final : public Correlator {
 public:
  TrackingCorrelator(CorrelationSettings settings, TrackingSettings const& tracking, GaussianWindow const& window)
      : tracking_(tracking), window_(window) {
    settings.method = "scc";
    predictor_ = make_correlator(settings);
  }

  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    DisplacementField predictor = predictor_->correlate(reference, flow);
    std::vector<VectorStatus> const status = predictor.status;
    for (std::size_t i = 0; i < predictor.ambiguous.size(); ++i)
      if (predictor.ambiguous[i] != Ambiguity::none && !predictor.status.empty())
        predictor.status[i] = VectorStatus::invalid;
    DisplacementField const dots = track_dots(reference, flow, predictor, tracking_);
    DisplacementField field = interpolate_vectors(dots, predictor.position_px, window_);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (status[i] != VectorStatus::masked) continue;
      field.status[i] = VectorStatus::masked;
      field.reason[i] = VectorReason::masked;
      field.displacement_px[i] = field.sigma_px[i] = {not_a_number, not_a_number};
    }
    field.columns = predictor.columns;
    field.rows = predictor.rows;
    field.raw_px = field.displacement_px;
    field.peak_ratio.assign(field.size(), not_a_number);
    field.correlation.assign(field.size(), not_a_number);
    field.failed.assign(field.size(), FailedTest::none);
    field.ambiguous.assign(field.size(), Ambiguity::none);
    field.verdict = predictor.verdict;
    field.warnings = predictor.warnings;
    field.warnings.insert(field.warnings.end(), dots.warnings.begin(), dots.warnings.end());
    return field;
  }

 private:
  std::unique_ptr<Correlator> predictor_;
  TrackingSettings tracking_;
  GaussianWindow window_;
};

}  // namespace

std::unique_ptr<Correlator> make_tracking_correlator(CorrelationSettings const& settings,
                                                     TrackingSettings const& tracking, GaussianWindow const& window) {
  return std::make_unique<TrackingCorrelator>(settings, tracking, window);
}

}  // namespace gladstone::tracking
