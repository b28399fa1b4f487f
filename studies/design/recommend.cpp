#include "studies/design/recommend.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <numeric>
#include <optional>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"

namespace gladstone::inline design {
namespace {

constexpr double stricter = 0.01;
constexpr double spare = 1e-4;  ///< a limit is active if its margin is below this value, as the logarithm of a ratio
constexpr int front_points = 13;
constexpr double front_span = 1.6;  ///< range of limits on the front, as a factor to either side of the required one

/// Adds the limits that every set-up must meet, which depend on the branch's camera.
DesignProblem complete(DesignProblem problem, DesignBranch const& branch) {
  for (Limit const& limit : feasibility_limits(*branch.given)) problem.limits.push_back(limit);
  return problem;
}

/// Makes a limit stricter by a factor above 1, and looser by a factor below 1.
double moved(Limit const& limit, double factor) {
  return limit.bound->from_below ? limit.value * factor : limit.value / factor;
}

/// Branches of a requested design, and the designs found so far in each of them.
struct Search {
  std::vector<DesignBranch> const& branches;
  std::vector<KnownDesigns> known{branches.size()};

  std::vector<BranchOutcome> solved(DesignProblem const& problem) { return solve_branches(problem, branches, &known); }
  bool feasible(DesignProblem const& problem) { return any_feasible(problem, branches, known); }
  double objective(DesignProblem const& problem) {
    BranchSolution const best = solved(problem).front().solution;
    return best.feasible() ? best.objective : HUGE_VAL;
  }
  double objective_with(DesignProblem problem, std::size_t index, double limit) {
    problem.limits[index].value = limit;
    return objective(problem);
  }
};

std::vector<std::string> list_active_limits(DesignProblem const& problem, BranchOutcome const& best) {
  std::vector<std::string> names;
  DesignPoint<double> const bench = design_point_at(best.branch, best.solution.logarithms);
  for (Limit const& limit : complete(problem, best.branch).limits) {
    if (excess(limit, bench) > -spare) names.emplace_back(limit.bound->name);
  }
  for (std::size_t i = 0; i < best.branch.continuous.size(); ++i) {
    FreeChoice const& free = best.branch.continuous[i];
    double const x = best.solution.logarithms[i];
    std::string const key = std::string("limits.") + choice_key(free.choice).limit;
    bool const at_low = x - std::log(free.low) < spare, at_high = std::log(free.high) - x < spare;
    if (at_low && at_high)
      names.push_back(key);  // the interval contains a single value
    else if (at_low || at_high)
      names.push_back(key + (at_low ? "[0]" : "[1]"));
  }
  return names;
}

/// Adds the costs of the requirements.
/// @return the best objective of the stricter problems
double add_costs(Recommendation& answer, DesignProblem const& problem, Search& search) {
  double const best = answer.outcomes.front().solution.objective;
  double dearest = 1e-4, least = best;
  answer.costs.clear();
  answer.front_bound = nullptr;
  for (std::size_t i = 0; i < problem.limits.size(); ++i) {
    double const then = search.objective_with(problem, i, moved(problem.limits[i], 1 + stricter));
    least = std::min(least, then);
    double const change = std::isfinite(then) ? then / best - 1 : HUGE_VAL;
    answer.costs.push_back({problem.limits[i].bound, change});
    double const counted = std::isfinite(change) ? change : 1.0;
    if (counted <= dearest) continue;
    dearest = counted;
    answer.front_bound = problem.limits[i].bound;
  }
  return least;
}

/// Adds the front: the best objectives for a series of limits of one requirement.
/// @return the best of the objectives whose limit is at least as strict as the required one
double add_front(Recommendation& answer, DesignProblem const& problem, Search& search) {
  answer.front.clear();
  if (!answer.front_bound) return HUGE_VAL;
  auto const of_front = std::find_if(problem.limits.begin(), problem.limits.end(),
                                     [&](Limit const& limit) { return limit.bound == answer.front_bound; });
  auto const index = static_cast<std::size_t>(of_front - problem.limits.begin());
  double least = HUGE_VAL;
  // the strictest limit first, since its solutions are also feasible with all other limits
  for (int k = 0; k < front_points; ++k) {
    double const lenience = std::pow(front_span, 2.0 * k / (front_points - 1) - 1);
    double const limit = moved(*of_front, 1 / lenience);
    double const then = search.objective_with(problem, index, limit);
    if (lenience < 1 + 1e-9) least = std::min(least, then);
    if (std::isfinite(then)) answer.front.push_back({limit, then});
  }
  std::sort(answer.front.begin(), answer.front.end(),
            [](FrontPoint const& a, FrontPoint const& b) { return a.limit < b.limit; });
  return least;
}

/// Adds costs and front. If a stricter problem has a better objective, its solution improves that of the actual
/// requirements, so they are solved again from it.
void add_costs_and_front(Recommendation& answer, DesignProblem const& problem, Search& search) {
  constexpr int most_rounds = 8;
  constexpr double gain = 1 - 1e-6;  // improvements below this factor are ignored
  for (int round = 0; round < most_rounds; ++round) {
    double const best = answer.outcomes.front().solution.objective;
    double least = add_costs(answer, problem, search);
    if (least >= best * gain) least = add_front(answer, problem, search);
    if (least >= best * gain) return;
    answer.outcomes = search.solved(problem);
  }
}

/// Returns the smallest set of limits that no design meets together.
std::vector<std::size_t> smallest_conflict(DesignProblem const& problem, Search& search) {
  std::size_t const count = problem.limits.size();
  for (std::size_t size = 0; size <= count; ++size) {
    for (std::uint32_t set = 0; set < (1u << count); ++set) {
      if (static_cast<std::size_t>(std::popcount(set)) != size) continue;
      DesignProblem part{problem.objective, {}};
      std::vector<std::size_t> chosen;
      for (std::size_t i = 0; i < count; ++i) {
        if ((set >> i & 1u) == 0) continue;
        chosen.push_back(i);
        part.limits.push_back(problem.limits[i]);
      }
      if (!search.feasible(part)) return chosen;
    }
  }
  return {};
}

constexpr double most_lenient = 1e3;  ///< maximum factor by which limits are relaxed

/// Relaxes the given limits by a factor.
DesignProblem relaxed(DesignProblem problem, std::vector<std::size_t> const& those, double factor) {
  for (std::size_t const index : those) problem.limits[index].value = moved(problem.limits[index], 1 / factor);
  return problem;
}

/// Returns the smallest factor by which the given limits must be relaxed to meet the others; nullopt if none suffices.
std::optional<double> least_factor(DesignProblem const& problem, std::vector<std::size_t> const& those,
                                   Search& search) {
  if (!search.feasible(relaxed(problem, those, most_lenient))) return std::nullopt;
  double low = 1, high = most_lenient;
  while (high / low > 1.001) {
    double const middle = std::sqrt(low * high);
    (search.feasible(relaxed(problem, those, middle)) ? high : low) = middle;
  }
  return high;
}

/// Adds a joint relaxation if none suffices alone: all limits by the smallest common factor, except those that need not
/// be relaxed.
void add_joint_relaxation(Recommendation& answer, DesignProblem const& problem, Search& search) {
  std::vector<std::size_t> those(problem.limits.size());
  std::iota(those.begin(), those.end(), std::size_t{0});
  std::optional<double> factor = least_factor(problem, those, search);
  if (!factor) return;
  for (std::size_t i = problem.limits.size(); i-- > 0;) {
    std::vector<std::size_t> fewer = those;
    fewer.erase(std::find(fewer.begin(), fewer.end(), i));
    if (fewer.empty() || !search.feasible(relaxed(problem, fewer, *factor))) continue;
    those = std::move(fewer);
  }
  for (std::size_t const index : those) {
    answer.together.push_back({problem.limits[index].bound, moved(problem.limits[index], 1 / *factor)});
  }
}

/// Adds the smallest relaxation of each conflicting limit for which the others are met; width and height of the view
/// are relaxed together.
void add_relaxations(Recommendation& answer, DesignProblem const& problem, std::vector<std::size_t> const& conflict,
                     Search& search) {
  for (std::size_t const index : conflict) {
    answer.conflicts.push_back(problem.limits[index].bound);
    std::vector<std::size_t> those;
    for (std::size_t i = 0; i < problem.limits.size(); ++i) {
      bool const both_views = problem.limits[i].bound->from_below && problem.limits[index].bound->from_below;
      if (i == index || both_views) those.push_back(i);
    }
    if (std::optional<double> const factor = least_factor(problem, those, search)) {
      answer.relaxations.push_back({problem.limits[index].bound, moved(problem.limits[index], 1 / *factor)});
    }
  }
  if (answer.relaxations.empty()) add_joint_relaxation(answer, problem, search);
}

/// If no design is feasible, searches again, starting from solutions of problems with one limit dropped.
void search_again(Recommendation& answer, DesignProblem const& problem, Search& search) {
  for (std::size_t i = 0; i < problem.limits.size(); ++i) {
    DesignProblem without = problem;
    without.limits.erase(without.limits.begin() + static_cast<std::ptrdiff_t>(i));
    search.solved(without);
  }
  answer.outcomes = search.solved(problem);
}

}  // namespace

std::vector<BranchOutcome> solve_branches(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                                          std::vector<KnownDesigns>* known) {
  throw_if_interrupted();
  std::vector<BranchOutcome> outcomes(branches.size());
  parallel_for(branches.size(), [&](std::size_t i) {
    DesignProblem const whole = complete(problem, branches[i]);
    BranchOutcome& outcome = outcomes[i];
    outcome.branch = branches[i];
    if (Bound const* const bound = excluded_by(whole, branches[i])) {
      outcome.skipped = true;
      outcome.solution.worst = bound;
    } else {
      outcome.solution = solve(whole, branches[i], known ? (*known)[i] : KnownDesigns{});
      if (known) (*known)[i].push_back(outcome.solution.logarithms);
    }
  });
  std::stable_sort(outcomes.begin(), outcomes.end(), [](BranchOutcome const& a, BranchOutcome const& b) {
    if (a.solution.feasible() != b.solution.feasible()) return a.solution.feasible();
    return a.solution.feasible() ? a.solution.objective < b.solution.objective
                                 : a.solution.violation < b.solution.violation;
  });
  return outcomes;
}

bool any_feasible(DesignProblem const& problem, std::vector<DesignBranch> const& branches,
                  std::vector<KnownDesigns> const& known) {
  throw_if_interrupted();
  std::atomic<bool> found = false;
  parallel_for(branches.size(), [&](std::size_t i) {
    if (found) return;
    DesignProblem const whole = complete(problem, branches[i]);
    if (excluded_by(whole, branches[i])) return;
    BranchSolution const least = least_violation(whole, branches[i], known.empty() ? KnownDesigns{} : known[i]);
    if (least.feasible()) found = true;
  });
  return found;
}

Recommendation recommend(Objective objective, std::vector<Limit> const& required,
                         std::vector<DesignBranch> const& branches) {
  DesignProblem const problem{objective, required};
  Search search{branches};
  Recommendation answer;
  answer.outcomes = search.solved(problem);
  if (!answer.feasible()) search_again(answer, problem, search);
  if (answer.feasible()) {
    add_costs_and_front(answer, problem, search);
    answer.binding = list_active_limits(problem, answer.outcomes.front());
  } else {
    std::vector<std::size_t> const conflict = smallest_conflict(problem, search);
    if (conflict.empty()) answer.without_requirements = search.solved({objective, {}}).front();
    add_relaxations(answer, problem, conflict, search);
  }
  return answer;
}

}  // namespace gladstone::inline design
