#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/design/solve.h"

namespace gladstone {

/// What became of one combination of the values to choose from.
struct BranchOutcome {
  DesignBranch branch;
  BranchSolution solution;
  bool skipped = false;  ///< `solution.worst` is the bound that excluded it before anything was solved
};

/// What a requirement costs: the objective's change where the requirement is 1 % stricter.
struct RequirementCost {
  Bound bound;
  double change = 0;  ///< of the objective, relative; infinite: nothing is feasible then
};

/// A requirement that would have to give way, and how far. In SI.
struct Relaxation {
  Bound bound;
  double value;
};

/// The best objective against one requirement's limit. In SI.
struct FrontPoint {
  double limit;
  double objective;
};

/// An answer to a design question.
struct Recommendation {
  std::vector<BranchOutcome> outcomes;  ///< of every branch, the best first where one is feasible
  // where one is feasible
  std::vector<std::string> binding;  ///< bounds that the best keeps with nothing to spare, ends of intervals among them
  std::vector<RequirementCost> costs;
  std::vector<FrontPoint> front;  ///< against `front_bound`; empty: nothing conflicts with the objective
  Bound front_bound = Bound::focus;
  // where none is
  std::vector<Bound> conflicts;  ///< the fewest requirements that cannot be kept together
  /// Where none is kept even without them: of every branch's best without any, the one that misses least.
  std::optional<BranchOutcome> without_requirements;
  std::vector<Relaxation> relaxations;  ///< of which one would do, the others kept
  std::vector<Relaxation> together;     ///< where no single one would: these would, by one share of each
  bool feasible() const { return !outcomes.empty() && outcomes.front().solution.feasible(); }
};

/// Solves every branch.
/// @param known of every branch, or null; what is found is added to it
/// @return outcomes, the best first
std::vector<BranchOutcome> solve_branches(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                                          std::vector<KnownBenches>* known = nullptr);

/// Whether any branch has a bench within the limits.
/// @param known of every branch, or empty
bool any_feasible(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                  std::vector<KnownBenches> const& known = {});

/// The best bench, what binds and what each requirement costs; or the smallest set of requirements that conflict, and
/// how far each of them would have to give way for the others to be kept; where none alone would do, which together.
/// @param required the user's limits; those of every bench come on top
Recommendation recommend(Objective objective, std::vector<Limit> const& required,
                         std::vector<DesignBranch> const& branches);

}  // namespace gladstone
