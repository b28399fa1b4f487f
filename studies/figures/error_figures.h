#pragma once

#include <string>
#include <vector>

#include "analysis/errors/error_budget.h"
#include "analysis/errors/error_summary.h"
#include "analysis/errors/uncertainty_quality.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/vec.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Errors of a measurement against one reference at the compared vectors.
struct ErrorSeries {
  std::string name;             ///< "against ray truth", "against Eq. 9", ...
  std::vector<Vec2d> error_px;  ///< non-finite values are omitted [px]
};

/// Probability density of the error, u and v side by side, one curve per series, with bias and random error
/// in the legend. The axis extends to the 99 % quantile of the widest series, but at most 8 times that of the
/// narrowest.
Figure make_error_histograms(std::string const& title, std::vector<ErrorSeries> const& series);

/// Median magnitude of the error against local_gradient(truth), in up to 15 bins of equal count, with the
/// band from the 10th to the 90th percentile.
/// @param truth  true displacement at the vectors, common to all series
Figure make_error_against_gradient(std::string const& title, DisplacementField const& truth,
                                   std::vector<ErrorSeries> const& series);

/// Returns the largest singular value of grad(displacement) at every vector of a grid [px/px], by central differences,
/// one-sided at the edges; NaN if a neighbour is missing.
/// @pre field.columns and rows are set
std::vector<double> local_gradient(DisplacementField const& field);

/// Error budget: bias and random error of every known term in both components, and its rms.
Figure make_budget_bars(std::string const& title, ErrorBudget const& budget);

/// rms error against estimated uncertainty in bins of equal count, with the line on which they are equal.
Figure make_reliability_figure(std::vector<UncertaintyBin> const& bins);

}  // namespace gladstone::inline figures
