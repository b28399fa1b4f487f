#pragma once

#include <vector>

#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Collects the available displacements of a comparison's chain as input of error_budget().
/// @param window  stage `window`: comparison.window or comparison.recorded()
std::vector<BudgetStage> budget_stages(Comparison const& comparison, WindowTruth const& window);

/// Computes the contribution of each error source at the compared vectors (NaN at the others) as the difference of
/// successive available stages. The terms are named as those of shown_budget(). If stages are missing, the difference
/// across the gap is assigned to the first term of the gap, as in the budget.
std::vector<BudgetStage> budget_differences(Comparison const& comparison);

}  // namespace gladstone::inline compare
