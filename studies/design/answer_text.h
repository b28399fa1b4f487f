#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/branches.h"
#include "studies/design/recommend.h"
#include "studies/design/verification.h"

namespace gladstone::inline design {

/// A requested design (requirements and design variables) with the recommendation, the variants of camera and lens, and
/// the verification.
struct AnsweredQuestion {
  DesignQuestion question;
  std::vector<DesignVariant> variants;
  Recommendation answer;
  /// result of the simulations; empty if none was requested or no design is feasible
  std::optional<Verification> verification;
  std::vector<SkippedVariant> skipped = {};  ///< cameras and lenses that are incompatible with the setup

  /// Returns the recommended design: the best one that meets the requirements in simulation, or the best by formula if
  /// none was simulated.
  /// @pre answer.feasible()
  BranchOutcome const& chosen() const {
    bool const simulated = verification && verification->chosen;
    return simulated ? verification->benches[*verification->chosen].outcome : answer.outcomes.front();
  }
  DesignPoint<double> best() const { return design_point_at(chosen().branch, chosen().solution.logarithms); }
  /// Returns true if a design is feasible by formula and no simulation contradicts it.
  bool feasible() const { return answer.feasible() && (!verification || verification->chosen || !verification->any()); }
};

/// Formats the answer: recommended design, predicted performance, active limits and the cost of each requirement; or
/// the conflicting requirements.
std::string answer_text(AnsweredQuestion const& answered);

/// Returns the answer as JSON with the keys feasible, recommended {key path: value}, predicted, binding, costs, front,
/// alternatives, conflicts and relaxations.
nlohmann::ordered_json answer_json(AnsweredQuestion const& answered);

}  // namespace gladstone::inline design
