#pragma once

#include "studies/design/bounds.h"

namespace gladstone {

/// By which a bench may exceed a limit and still keep it, as the logarithm of a ratio: rounding of a solution on it.
inline constexpr double allowed_excess = 1e-7;

/// The best bench of a branch.
struct BranchSolution {
  std::vector<double> logarithms;  ///< of the continuous choices
  double objective = HUGE_VAL;     ///< in SI
  double violation = HUGE_VAL;     ///< largest excess over a limit
  Bound worst = Bound::focus;      ///< the limit that it is of

  bool feasible() const { return violation <= allowed_excess; }
};

/// Benches of a branch that are known from other problems, by the logarithms of the continuous choices: more starts,
/// and a solution is never worse than the best of them.
using KnownBenches = std::vector<std::vector<double>>;

/// Why no bench of the branch can keep a limit, told by the ends of its intervals alone; nothing: it may.
std::optional<Bound> excluded_by(DesignProblem const& problem, DesignBranch const& branch);

/// Minimises the objective within the limits by sequential quadratic programming (Kraft's SLSQP, ACM Trans. Math.
/// Softw. 20 (1994) 262, as NLopt has it) in the logarithms of the choices, with derivatives from Jets, from several
/// starts. Where none keeps the limits, the bench that exceeds them least.
BranchSolution solve(DesignProblem const& problem, DesignBranch const& branch, KnownBenches const& known = {});

/// The bench that exceeds its worst limit least, with no regard to the objective. Ends early where one keeps them all.
BranchSolution least_violation(DesignProblem const& problem, DesignBranch const& branch,
                               KnownBenches const& known = {});

}  // namespace gladstone
