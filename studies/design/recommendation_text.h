#pragma once

#include <string>

#include "studies/design/answer_text.h"

namespace gladstone::inline design {

/// Returns the name of the objective, e.g. "gradient_min".
char const* objective_word(AnsweredQuestion const& answered);
/// Converts an objective from SI to the unit of its key.
double written_objective(AnsweredQuestion const& answered, double objective);

/// Returns the objective of a combination, or the constraint that it violates.
std::string outcome_verdict(AnsweredQuestion const& answered, BranchOutcome const& outcome);

/// Describes the recommended set-up in five lines: lens, stop, target distance, dots, and smallest gradient with the
/// random error. Further lines describe the results for the next larger and the next smaller f-number: of the
/// inventory, with the other free keys optimised for it, or else a full stop away, with everything else unchanged.
/// @pre answered.answer.feasible()
std::string recommendation_text(AnsweredQuestion const& answered);

}  // namespace gladstone::inline design
