#include "analysis/standard_correlator.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "analysis/fft_correlation.h"
#include "analysis/vector_validation.h"
#include "analysis/window_deformation.h"
#include "render/base/contracts.h"
#include "render/base/error.h"

namespace gladstone {
namespace {

class StandardCorrelator final : public Correlator {
 public:
  explicit StandardCorrelator(CorrelationSettings const& settings)
      : settings_(settings),
        weighting_(window_weighting(settings)),
        rule_{settings.median_threshold, settings.median_epsilon_px},
        passes_(settings.window_px) {
    GLADSTONE_EXPECTS(!passes_.empty() && settings.final_passes >= 1);
    passes_.insert(passes_.end(), static_cast<std::size_t>(settings.final_passes - 1), settings.window_px.back());
  }

  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    int const columns = reference.columns(), rows = reference.rows();
    if (flow.columns() != columns || flow.rows() != rows)
      throw DataError("image pair", fmt::format("images of different size ({} x {} and {} x {} px)", columns, rows,
                                                flow.columns(), flow.rows()));
    if (std::string const problem = window_problem(settings_, columns, rows); !problem.empty())
      throw DataError("image pair", problem);

    std::optional<PairDeformer> deformer;
    if (passes_.size() > 1) deformer.emplace(reference, flow, settings_.deformation == "cubic" ? 3 : 5);
    std::optional<DensePredictor> predictor;
    for (std::size_t pass = 0;; ++pass) {
      bool const last = pass + 1 == passes_.size();
      InterrogationGrid const grid = make_interrogation_grid(columns, rows, passes_[pass], settings_.overlap);
      ImagePair const pair = predictor ? deformer->deform(*predictor) : make_image_pair(reference, flow);
      std::vector<WindowCorrelation> const windows =
          correlate_windows(pair, grid, weighting_, std::max(1, passes_[pass] / (pass == 0 ? 2 : 4)),
                            fmt::format("correlate {}/{}", pass + 1, passes_.size()));
      std::vector<GridVector> vectors = grid_vectors(windows);
      // what a pass adds to its predictor is validated, not the sum: there steep gradients are already taken off
      validate_vectors(vectors, grid.columns, last ? rule_ : predictor_rule());
      if (predictor)
        for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i].displacement += predictor->at(grid.centre(i));
      if (last) return result(vectors, windows, grid);
      std::vector<Vec2d> const nodes = smoothed_displacement(filled_displacement(vectors, grid.columns), grid.columns);
      predictor.emplace(grid, nodes, columns, rows);
    }
  }

 private:
  /// A predictor that is off by half a pixel does no harm, one that has lost a steep gradient does: only gross errors
  /// are taken out between passes.
  ValidationRule predictor_rule() const { return {rule_.threshold, std::max(rule_.epsilon_px, 0.5)}; }

  static std::vector<GridVector> grid_vectors(std::vector<WindowCorrelation> const& windows) {
    std::vector<GridVector> vectors(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      WindowCorrelation const& window = windows[i];
      GridVector& vector = vectors[i];
      if (window.outcome == WindowCorrelation::Outcome::masked) vector.status = VectorStatus::masked;
      if (window.outcome != WindowCorrelation::Outcome::measured) continue;
      vector.status = VectorStatus::valid;
      vector.displacement = window.shift[0];
      vector.alternative_count = window.peaks - 1;
      for (int k = 1; k < window.peaks; ++k) vector.alternatives[k - 1] = window.shift[k];
    }
    return vectors;
  }

  static DisplacementField result(std::vector<GridVector> const& vectors, std::vector<WindowCorrelation> const& windows,
                                  InterrogationGrid const& grid) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    DisplacementField field;
    field.columns = grid.columns;
    field.rows = grid.rows;
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      bool const known = vectors[i].status == VectorStatus::valid || vectors[i].status == VectorStatus::replaced;
      bool const measured = windows[i].outcome == WindowCorrelation::Outcome::measured;
      field.position_px.push_back(grid.centre(i));
      field.displacement_px.push_back(known ? vectors[i].displacement : Vec2d{nan, nan});
      field.peak_ratio.push_back(measured ? windows[i].peak_ratio : nan);
      field.status.push_back(vectors[i].status);
    }
    return field;
  }

  CorrelationSettings settings_;
  WindowWeighting weighting_;
  ValidationRule rule_;
  std::vector<int> passes_;
};

}  // namespace

std::unique_ptr<Correlator> make_standard_correlator(CorrelationSettings const& settings) {
  return std::make_unique<StandardCorrelator>(settings);
}

WindowWeighting window_weighting(CorrelationSettings const& settings) {
  GLADSTONE_EXPECTS(settings.weighting == "gaussian" || settings.weighting == "uniform");
  return settings.weighting == "gaussian" ? WindowWeighting::gaussian : WindowWeighting::uniform;
}

}  // namespace gladstone
