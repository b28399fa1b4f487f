#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/errors/error_budget.h"
#include "analysis/errors/error_summary.h"
#include "render/base/displacement_field.h"
#include "render/base/vec.h"

namespace gladstone {

/// Errors of a measurement against one reference [px], at the vectors that count.
struct ErrorSeries {
  std::string name;             ///< "against ray truth", "against Eq. 9", ...
  std::vector<Vec2d> error_px;  ///< what is not finite is left out
};

/// Probability density of the error, u and v side by side, one curve a series, with bias and random error in the
/// legend. The axis reaches to the 99 % quantile of the widest series, at most to 8 times that of the narrowest.
void write_error_histograms(std::string const& path, std::string const& title, std::vector<ErrorSeries> const& series);

/// Median magnitude of the error against the local gradient of the true displacement, local_gradient(truth), in up to
/// 15 bins of equal count, with the band from the 10th to the 90th percentile.
/// @param truth at the vectors of every series
void write_error_against_gradient(std::string const& path, std::string const& title, DisplacementField const& truth,
                                  std::vector<ErrorSeries> const& series);

/// Largest singular value of grad(displacement) at every vector of a grid [px/px], by central differences, one-sided at
/// the edges; NaN where a neighbour is missing. @pre field.columns and rows are set
std::vector<double> local_gradient(DisplacementField const& field);

/// The error budget: bias and random error of every known term in both components, and its rms.
void write_budget_bars(std::string const& path, std::string const& title, ErrorBudget const& budget);

}  // namespace gladstone
