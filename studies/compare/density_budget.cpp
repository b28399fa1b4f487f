#include "studies/compare/density_budget.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/density/density_methods.h"
#include "render/base/contracts.h"
#include "studies/compare/budget_stages.h"

namespace gladstone::inline compare {
namespace {

/// Statistics of a density difference over the nodes where it and the truth are finite.
DensityTerm summarize_term(std::string name, std::vector<double> const& to, std::vector<double> const& from,
                           std::vector<double> const& truth) {
  DensityTerm term{std::move(name)};
  double count = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    double const difference = to[i] - from[i];
    if (!std::isfinite(difference) || !std::isfinite(truth[i])) continue;
    term.bias += difference;
    squares += difference * difference;
    count += 1.0;
  }
  term.bias /= count;
  term.rms = std::sqrt(squares / count);
  return term;
}

}  // namespace

std::vector<DensityTerm> compute_density_budget(Comparison const& comparison, Reconstruction const& reconstruction,
                                                Setup const& setup, double window_px,
                                                ReconstructOptions const& options) {
  GLADSTONE_EXPECTS(comparison.chain == BudgetChain::bos && !reconstruction.truth.empty());
  ReconstructOptions fixed = options;
  fixed.propagate = false;
  if (reconstruction.axisymmetry) {  // use the same axis and regularisation for all stages
    fixed.axis->position = reconstruction.axisymmetry->axis.position;
    if (density::abel_method(fixed.abel).regularized) fixed.lambda = reconstruction.axisymmetry->lambda;
  }
  // Use only vectors with a displacement at every stage
  std::vector<BudgetStage> const causes = budget_differences(comparison);
  DisplacementField stage = comparison.measured;
  stage.displacement_px = comparison.point.eq9_px;
  stage.status.resize(stage.size(), VectorStatus::valid);
  for (std::size_t i = 0; i < stage.size(); ++i) {
    bool const is_complete = comparison.mask[i] != 0 && is_finite(stage.displacement_px[i]) &&
                             std::all_of(causes.begin(), causes.end(),
                                         [&](auto const& cause) { return is_finite(cause.displacement_px[i]); });
    if (!is_complete) stage.status[i] = VectorStatus::invalid;
  }

  // Add one cause after the other
  std::vector<double> before = reconstruct_density(stage, setup, window_px, fixed).density;
  std::vector<DensityTerm> terms{summarize_term("integration", before, reconstruction.truth, reconstruction.truth)};
  for (BudgetStage const& cause : causes) {
    for (std::size_t i = 0; i < stage.size(); ++i)
      if (stage.counts(i)) stage.displacement_px[i] = stage.displacement_px[i] + cause.displacement_px[i];
    std::vector<double> after = reconstruct_density(stage, setup, window_px, fixed).density;
    terms.push_back(summarize_term(cause.name, after, before, reconstruction.truth));
    before = std::move(after);
  }
  terms.push_back(summarize_term("total", before, reconstruction.truth, reconstruction.truth));
  return terms;
}

}  // namespace gladstone::inline compare
