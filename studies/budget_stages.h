#pragma once

#include <vector>

#include "studies/compare.h"

namespace gladstone {

/// The displacements of a comparison's chain that are known, for error_budget().
/// @param window the chain's stage `window`: comparison.window, or comparison.recorded()
std::vector<BudgetStage> budget_stages(Comparison const& comparison, WindowTruth const& window);

/// What each cause adds at the vectors that count (NaN at others), by the names of the terms of shown_budget(): the
/// difference of a stage and the one before it. Across a stage that is not known it goes to the gap's first term, as in
/// the budget.
std::vector<BudgetStage> budget_differences(Comparison const& comparison);

}  // namespace gladstone
