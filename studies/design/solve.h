#pragma once

#include "studies/design/bounds.h"

namespace gladstone::inline design {

/// Excess, as the logarithm of a ratio, up to which a limit counts as met; allows for rounding of solutions on the
/// limit.
inline constexpr double allowed_excess = 1e-7;

/// Best design of a branch.
struct BranchSolution {
  std::vector<double> logarithms;  ///< logarithms of the continuous design variables
  double objective = HUGE_VAL;     ///< objective [SI]
  double violation = HUGE_VAL;     ///< largest excess over a limit
  Bound const* worst = &in_focus;  ///< limit with the largest excess

  bool feasible() const { return violation <= allowed_excess; }
};

/// Designs of a branch from the solutions of other problems, as logarithms of the continuous design variables. They
/// serve as additional starting points; the solution is never worse than the best of them.
using KnownDesigns = std::vector<std::vector<double>>;

/// Returns a limit that no design of the branch can meet, determined from the ends of its intervals alone; null: not
/// excluded.
Bound const* excluded_by(DesignProblem const& problem, DesignBranch const& branch);

/// Minimizes the objective within the limits by sequential quadratic programming (Kraft's SLSQP, ACM Trans. Math.
/// Softw. 20 (1994) 262, as implemented in NLopt) in the logarithms of the design variables, with derivatives from Jets
/// and several starting points. If no design meets the limits, returns the one with the smallest excess.
BranchSolution solve(DesignProblem const& problem, DesignBranch const& branch, KnownDesigns const& known = {});

/// Minimizes the largest excess over a limit, ignoring the objective. Stops as soon as all limits are met.
BranchSolution least_violation(DesignProblem const& problem, DesignBranch const& branch,
                               KnownDesigns const& known = {});

}  // namespace gladstone::inline design
