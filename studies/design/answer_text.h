#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/design/branches.h"
#include "studies/design/recommend.h"

namespace gladstone {

/// A design question with its answer and all that both refer to.
struct AnsweredQuestion {
  DesignQuestion question;
  std::vector<DesignVariant> variants;
  Recommendation answer;

  /// The recommended bench. @pre answer.feasible()
  Bench<double> best() const {
    return bench_at(answer.outcomes.front().branch, answer.outcomes.front().solution.logarithms);
  }
};

/// The answer to read: what is recommended, what it will do, what binds, what each requirement costs; or what
/// conflicts.
std::string answer_text(AnsweredQuestion const& answered);

/// feasible, recommended {key path: value}, predicted, binding, costs, front, alternatives, conflicts, relaxations.
nlohmann::ordered_json answer_json(AnsweredQuestion const& answered);

}  // namespace gladstone
