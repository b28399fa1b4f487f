#include "analysis/correlation/standard_correlator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/plane_sums.h"
#include "analysis/correlation/steep_refinement.h"
#include "analysis/correlation/window_deformation.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/freed_memory.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t vectors_per_chunk = 512;

class StandardCorrelator final : public Correlator {
 public:
  explicit StandardCorrelator(CorrelationSettings const& settings)
      : settings_(settings),
        schedule_(settings),
        correlate_(correlation_method(settings.method).correlate),
        fit_(subpixel_method(settings.subpixel).fit) {}

  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override {
    int const columns = reference.columns(), rows = reference.rows();
    check_image_sizes(settings_, columns, rows, flow.columns(), flow.rows());
    std::optional<PairDeformer> deformer;
    ImagePair single, deformed;
    if (schedule_.passes() > 1)
      deformer.emplace(reference, flow, schedule_.spline_degree());
    else
      single = make_image_pair(reference, flow);
    return run_passes(columns, rows, [&](int pass, InterrogationGrid const& grid, DensePredictor const* predictor) {
      if (predictor != nullptr) deformer->deform(*predictor, deformed);
      ImagePair const& pair = predictor != nullptr ? deformed : (deformer ? deformer->original() : single);
      return correlate_(job(pass, pair, grid, nullptr));
    });
  }

  DisplacementField correlate_all(PairSequence const& pairs) const {
    HostFrames const first = pairs.frames(0);
    int const columns = first.reference().columns(), rows = first.reference().rows();
    return run_passes(columns, rows, [&](int pass, InterrogationGrid const& grid, DensePredictor const* predictor) {
      PlaneSums planes(grid.size(), schedule_.search_radius_px(pass));
      std::vector<WindowCorrelation> windows;
      for (std::size_t k = 0; k < pairs.size; ++k) {
        HostFrames const frames = pairs.frames(k);
        Image<double> const &reference = frames.reference(), &flow = frames.flow();
        check_image_sizes(settings_, reference.columns(), reference.rows(), flow.columns(), flow.rows());
        check_image_sizes(settings_, columns, rows, flow.columns(), flow.rows());
        ImagePair const pair = predictor == nullptr
                                   ? make_image_pair(reference, flow)
                                   : PairDeformer(reference, flow, schedule_.spline_degree()).deform(*predictor);
        windows = correlate_(job(pass, pair, grid, &planes));
      }
      return windows;
    });
  }

 private:
  InterrogationJob job(int pass, ImagePair const& pair, InterrogationGrid const& grid, PlaneSums* ensemble) const {
    return {pair,
            grid,
            schedule_.weighting(),
            schedule_.search_radius_px(pass),
            fit_,
            fmt::format("correlate {}/{}", pass + 1, schedule_.passes()),
            ensemble};
  }

  /// Runs all passes. @param measure  returns the windows of a grid in a pass, for frames deformed by the predictor; a
  /// null predictor in the first pass means no deformation
  template <class Measure>
  DisplacementField run_passes(int columns, int rows, Measure const& measure) const {
    std::optional<DensePredictor> predictor;
    std::vector<char> ambiguous;
    InterrogationGrid grid_before;
    for (int pass = 0;; ++pass) {
      InterrogationGrid const grid = schedule_.grid(pass, columns, rows);
      std::vector<WindowCorrelation> windows = measure(pass, grid, predictor ? &*predictor : nullptr);
      std::vector<GridVector> vectors(windows.size());
      auto const predicted = [&](std::size_t i) { return predictor ? predictor->at(grid.centre(i)) : Vec2d{}; };
      AmbiguousPlaces const before{grid_before, pass > 0 ? ambiguous.data() : nullptr};
      std::vector<char> ambiguous_now(vectors.size());
      parallel_chunks(vectors.size(), vectors_per_chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          vectors[i] = grid_vector(windows[i], predicted(i), schedule_.limit_px(), before.at(grid.centre(i)));
          ambiguous_now[i] = vectors[i].ambiguous != Ambiguity::none;
        }
      });
      ambiguous = std::move(ambiguous_now);
      grid_before = grid;
      validate_vectors(vectors, grid.columns, schedule_.rule(pass));
      if (schedule_.is_last(pass)) {
        RefinedPass last{std::move(vectors), std::move(windows)};
        refine(last, grid, columns, rows, measure);
        std::vector<MeasuredVector> measured(grid.size());
        std::transform(last.vectors.begin(), last.vectors.end(), last.windows.begin(), measured.begin(),
                       measured_vector);
        return displacement_field(grid, measured);
      }
      std::vector<Vec2d> const nodes =
          smoothed_displacement(filled_displacement(vectors, grid.columns), grid.columns, schedule_.smoothing(pass));
      predictor.emplace(grid, nodes, columns, rows);
    }
  }

  /// Repeats the last pass where displacement gradients are steep.
  template <class Measure>
  void refine(RefinedPass& last, InterrogationGrid const& grid, int columns, int rows, Measure const& measure) const {
    if (schedule_.steep_passes() == 0 || !has_steep_gradient(last.vectors, grid)) return;
    int const pass = schedule_.passes() - 1;
    ValidationRule const rule = schedule_.rule(pass);
    refine_steep_vectors(last, grid, schedule_.steep_passes(), rule, [&](RefinementPlan const& plan) {
      DensePredictor const predictor(grid, smoothed_displacement(plan.nodes, grid.columns, schedule_.steep_smoothing()),
                                     columns, rows);
      RefinedPass refined;
      refined.windows = measure(pass, grid, &predictor);
      for (std::size_t i = 0; i < grid.size(); ++i)
        refined.vectors.push_back(grid_vector(refined.windows[i], predictor.at(grid.centre(i)), schedule_.limit_px(),
                                              plan.ambiguous[i] != 0));
      validate_vectors(refined.vectors, grid.columns, rule);
      return refined;
    });
  }

  CorrelationSettings settings_;
  CorrelationSchedule schedule_;
  CorrelateWindows correlate_;
  SubpixelFit fit_;
};

}  // namespace

CorrelationSchedule::CorrelationSchedule(CorrelationSettings const& settings)
    : windows_(settings.window_px),
      overlap_(settings.overlap),
      last_rule_{settings.median_threshold.value_or(std::numeric_limits<double>::infinity()),
                 settings.median_epsilon_px,
                 settings.trusted_peak_ratio.value_or(std::numeric_limits<double>::infinity()),
                 settings.max_displacement_px.value_or(std::numeric_limits<double>::infinity()),
                 settings.least_peak_ratio.value_or(0.0),
                 settings.least_correlation.value_or(0.0),
                 settings.displacement_threshold.value_or(std::numeric_limits<double>::infinity()),
                 settings.replace},
      weighting_(window_weighting(settings)),
      spline_degree_(settings.deformation == "sinc"    ? windowed_sinc
                     : settings.deformation == "cubic" ? 3
                                                       : 5) {
  GLADSTONE_EXPECTS(!windows_.empty() && settings.final_passes >= 1);
  windows_.insert(windows_.end(), static_cast<std::size_t>(settings.final_passes - 1), settings.window_px.back());
  steep_passes_ = passes() > 1 && !correlation_method(settings.method).by_phase ? settings.steep_passes : 0;
}

int CorrelationSchedule::search_radius_px(int pass) const {
  int const widest = windows_[pass] / (pass == 0 ? 2 : 4);
  if (pass > 0 || limit_px() >= widest) return widest;
  // Round the displacement limit up to a multiple of four, because the CUDA kernels search groups of four shifts;
  // grid_vector() rejects peaks beyond the exact limit.
  return std::min(widest, 4 * static_cast<int>(std::ceil(limit_px() / 4.0)));
}

ValidationRule CorrelationSchedule::rule(int pass) const {
  ValidationRule rule = last_rule_;
  if (!is_last(pass)) {
    rule.epsilon_px = std::max(rule.epsilon_px, 0.5);
    rule.least_peak_ratio = rule.least_correlation = 0.0;
    rule.replaces = true;
  }
  if (pass > 0) rule.reliable_peak_ratio = std::numeric_limits<double>::infinity();
  // In the first pass the total displacement equals the increment, which the first test has already judged.
  if (pass == 0 || !is_last(pass)) rule.displacement_threshold = std::numeric_limits<double>::infinity();
  return rule;
}

double CorrelationSchedule::smoothing(int pass) const {
  int const last_predictor = std::max(0, passes() - 2);
  double const finest_px = grid_spacing_px(windows_[last_predictor], overlap_);
  return 0.25 * std::min(1.0, finest_px / grid_spacing_px(windows_[pass], overlap_));
}

void check_image_sizes(CorrelationSettings const& settings, int reference_columns, int reference_rows, int flow_columns,
                       int flow_rows) {
  if (flow_columns != reference_columns || flow_rows != reference_rows)
    throw DataError(ErrorCode::wrong_shape, "image pair",
                    fmt::format("images of different size ({} x {} and {} x {} px)", reference_columns, reference_rows,
                                flow_columns, flow_rows));
  if (std::string const problem = window_problem(settings, reference_columns, reference_rows); !problem.empty())
    throw DataError(ErrorCode::wrong_shape, "image pair", problem);
}

DisplacementField displacement_field(InterrogationGrid const& grid, std::span<MeasuredVector const> vectors) {
  GLADSTONE_EXPECTS(vectors.size() == grid.size());
  DisplacementField field;
  field.columns = grid.columns;
  field.rows = grid.rows;
  field.position_px.reserve(vectors.size());
  field.displacement_px.reserve(vectors.size());
  field.peak_ratio.reserve(vectors.size());
  field.status.reserve(vectors.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    field.position_px.push_back(grid.centre(i));
    field.displacement_px.push_back(vectors[i].displacement);
    field.peak_ratio.push_back(vectors[i].peak_ratio);
    field.status.push_back(vectors[i].status);
    field.raw_px.push_back(vectors[i].raw);
    field.correlation.push_back(vectors[i].correlation);
    field.reason.push_back(vectors[i].reason);
    field.failed.push_back(vectors[i].failed);
    field.ambiguous.push_back(vectors[i].ambiguous);
  }
  return field;
}

DisplacementField correlate_ensemble(PairSequence const& pairs, CorrelationSettings const& settings) {
  GLADSTONE_EXPECTS(pairs.size > 0);
  for (CorrelationMethod const& method : all_correlation_methods())
    if (settings.method == method.name && !method.in_ensembles)
      throw DataError(ErrorCode::unsupported, "ensemble",
                      fmt::format("correlate.method = \"{}\" does not support ensembles (it has no "
                                  "correlation planes to average); use another one, such as \"scc\"",
                                  settings.method));
  if (settings.estimates_uncertainty())
    throw DataError(ErrorCode::unsupported, "ensemble",
                    fmt::format("correlate.uncertainty = \"{}\" does not support ensembles (it compares "
                                "the matched frames of one pair); use \"none\"",
                                settings.uncertainty));
  return StandardCorrelator(settings).correlate_all(pairs);
}

std::unique_ptr<Correlator> make_standard_correlator(CorrelationSettings const& settings) {
  static std::once_flag once;
  // Memory returned to the system causes page faults, which take a sixth of the time of a pass in sequences of pairs.
  std::call_once(once, keep_freed_memory);
  return std::make_unique<StandardCorrelator>(settings);
}

WindowWeighting window_weighting(CorrelationSettings const& settings) {
  GLADSTONE_EXPECTS(settings.weighting == "gaussian" || settings.weighting == "uniform");
  return settings.weighting == "gaussian" ? WindowWeighting::gaussian : WindowWeighting::uniform;
}

}  // namespace gladstone::inline correlation
