#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/branches.h"
#include "studies/design/recommend.h"
#include "studies/design/verification.h"

namespace gladstone {

/// A design question with its answer and all that both refer to.
struct AnsweredQuestion {
  DesignQuestion question;
  std::vector<DesignVariant> variants;
  Recommendation answer;
  std::optional<Verification> verification;  ///< nothing: not asked for, or nothing is feasible
  std::vector<SkippedVariant> skipped = {};  ///< cameras and lenses that do not go with the setup

  /// What is recommended: the best that the simulation keeps to, or the best by formula where none was simulated.
  /// @pre answer.feasible()
  BranchOutcome const& chosen() const {
    bool const simulated = verification && verification->chosen;
    return simulated ? verification->benches[*verification->chosen].outcome : answer.outcomes.front();
  }
  Bench<double> best() const { return bench_at(chosen().branch, chosen().solution.logarithms); }
  /// Whether the formulas have a design and no simulation says that it is none.
  bool feasible() const { return answer.feasible() && (!verification || verification->chosen || !verification->any()); }
};

/// The answer to read: what is recommended, what it will do, what binds, what each requirement costs; or what
/// conflicts.
std::string answer_text(AnsweredQuestion const& answered);

/// feasible, recommended {key path: value}, predicted, binding, costs, front, alternatives, conflicts, relaxations.
nlohmann::ordered_json answer_json(AnsweredQuestion const& answered);

}  // namespace gladstone
