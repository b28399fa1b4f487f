#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/design/solve.h"

namespace gladstone::inline design {

/// Result for one combination of the discrete design variables.
struct BranchOutcome {
  DesignBranch branch;
  BranchSolution solution;
  bool skipped = false;  ///< true: excluded without optimisation, because of the limit `solution.worst`
};

/// Cost of a requirement: change of the objective if the requirement is 1 % stricter.
struct RequirementCost {
  Bound const* bound;
  double change = 0;  ///< relative change of the objective; infinite if no design is feasible then [1]
};

/// Limit of a requirement to which it would have to be relaxed, in SI.
struct Relaxation {
  Bound const* bound;
  double value;
};

/// Best objective for one limit of a requirement, in SI.
struct FrontPoint {
  double limit;
  double objective;
};

/// Recommended design, or the reasons why no design is feasible.
struct Recommendation {
  std::vector<BranchOutcome> outcomes;  ///< outcomes of every branch; the best one first if any is feasible
  // only if a design is feasible:
  std::vector<std::string> binding;  ///< active limits of the best design, including ends of intervals
  std::vector<RequirementCost> costs;
  /// trade-off: the best objective for each limit of the requirement `front_bound`; empty if no requirement restricts
  /// the objective
  std::vector<FrontPoint> front;
  Bound const* front_bound = nullptr;
  // only if no design is feasible:
  std::vector<Bound const*> conflicts;  ///< smallest set of requirements that cannot be met together
  /// Branch with the smallest violation if no design is feasible even without requirements.
  std::optional<BranchOutcome> without_requirements;
  std::vector<Relaxation> relaxations;  ///< relaxations of a single requirement, each of which suffices
  std::vector<Relaxation> together;     ///< joint relaxation by a common factor, if no single one suffices
  bool feasible() const { return !outcomes.empty() && outcomes.front().solution.feasible(); }
};

/// Solves every branch.
/// @param known  known designs of every branch, or null; solutions are added to it
/// @return outcomes, the best one first
std::vector<BranchOutcome> solve_branches(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                                          std::vector<KnownDesigns>* known = nullptr);

/// Returns true if any branch has a design within the limits.
/// @param known  known designs of every branch, or empty
bool any_feasible(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                  std::vector<KnownDesigns> const& known = {});

/// Determines the best design, its active limits and the cost of each requirement; or the smallest set of conflicting
/// requirements and the relaxation of each that suffices while the others are met; or, if no single one does, a joint
/// relaxation.
/// @param required  limits of the user; those of every set-up are added
Recommendation recommend(Objective objective, std::vector<Limit> const& required,
                         std::vector<DesignBranch> const& branches);

}  // namespace gladstone::inline design
