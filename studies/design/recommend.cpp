#include "studies/design/recommend.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>

#include "render/base/interrupt.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

constexpr double stricter = 0.01;
constexpr double spare = 1e-4;  ///< below which a bound binds, as the logarithm of a ratio
constexpr int front_points = 13;
constexpr double front_span = 1.6;  ///< either way of the limit as required

/// With the limits of every bench, which hang on the branch's camera.
DesignProblem complete(DesignProblem problem, DesignBranch const& branch) {
  for (Limit const& limit : bench_limits(*branch.given)) problem.limits.push_back(limit);
  return problem;
}

/// Whether a limit is one from below: stricter is more.
bool from_below(Bound bound) { return bound == Bound::view_width || bound == Bound::view_height; }

double moved(Limit const& limit, double factor) {
  return from_below(limit.bound) ? limit.value * factor : limit.value / factor;
}

double best_objective(DesignProblem const& problem, std::vector<DesignBranch> const& branches) {
  BranchSolution const best = solve_branches(problem, branches).front().solution;
  return best.feasible() ? best.objective : HUGE_VAL;
}

double objective_with(DesignProblem problem, std::size_t index, double limit,
                      std::vector<DesignBranch> const& branches) {
  problem.limits[index].value = limit;
  return best_objective(problem, branches);
}

std::vector<std::string> binding_of(DesignProblem const& problem, BranchOutcome const& best) {
  std::vector<std::string> names;
  Bench<double> const bench = bench_at(best.branch, best.solution.logarithms);
  for (Limit const& limit : complete(problem, best.branch).limits) {
    if (excess(limit, bench) > -spare) names.push_back(bound_name(limit.bound));
  }
  for (std::size_t i = 0; i < best.branch.continuous.size(); ++i) {
    FreeChoice const& free = best.branch.continuous[i];
    double const x = best.solution.logarithms[i];
    std::string const key = std::string("limits.") + key_of(free.choice).limit;
    if (x - std::log(free.low) < spare) names.push_back(key + "[0]");
    if (std::log(free.high) - x < spare) names.push_back(key + "[1]");
  }
  return names;
}

void add_costs(Recommendation& answer, DesignProblem const& problem, std::vector<DesignBranch> const& branches) {
  double const best = answer.outcomes.front().solution.objective;
  double dearest = 1e-4;
  for (std::size_t i = 0; i < problem.limits.size(); ++i) {
    double const then = objective_with(problem, i, moved(problem.limits[i], 1 + stricter), branches);
    double const change = std::isfinite(then) ? then / best - 1 : HUGE_VAL;
    answer.costs.push_back({problem.limits[i].bound, change});
    double const counted = std::isfinite(change) ? change : 1.0;
    if (counted <= dearest) continue;
    dearest = counted;
    answer.front_bound = problem.limits[i].bound;
  }
  if (answer.front_bound == Bound::focus) return;
  auto const of_front = std::find_if(problem.limits.begin(), problem.limits.end(),
                                     [&](Limit const& limit) { return limit.bound == answer.front_bound; });
  auto const index = static_cast<std::size_t>(of_front - problem.limits.begin());
  for (int k = 0; k < front_points; ++k) {
    double const limit = of_front->value * std::pow(front_span, 2.0 * k / (front_points - 1) - 1);
    double const then = objective_with(problem, index, limit, branches);
    if (std::isfinite(then)) answer.front.push_back({limit, then});
  }
}

/// The fewest of the limits that no bench keeps together.
std::vector<std::size_t> smallest_conflict(DesignProblem const& problem, std::vector<DesignBranch> const& branches) {
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
      if (!any_feasible(part, branches)) return chosen;
    }
  }
  return {};
}

/// The least that a limit has to give way, the others kept: the share of it by which the most lenient bench exceeds it.
void add_relaxations(Recommendation& answer, DesignProblem const& problem, std::vector<std::size_t> const& conflict,
                     std::vector<DesignBranch> const& branches) {
  constexpr double most = 1e3;  // no one gives way further
  for (std::size_t const index : conflict) {
    answer.conflicts.push_back(problem.limits[index].bound);
    auto const feasible_at = [&](double factor) {
      DesignProblem relaxed = problem;
      // width and height of the view give way together
      for (std::size_t i = 0; i < problem.limits.size(); ++i) {
        bool const same =
            i == index || (from_below(problem.limits[i].bound) && from_below(problem.limits[index].bound));
        if (same) relaxed.limits[i].value = moved(problem.limits[i], 1 / factor);
      }
      return any_feasible(relaxed, branches);
    };
    if (!feasible_at(most)) continue;
    double low = 1, high = most;
    while (high / low > 1.001) {
      double const middle = std::sqrt(low * high);
      (feasible_at(middle) ? high : low) = middle;
    }
    answer.relaxations.push_back({problem.limits[index].bound, moved(problem.limits[index], 1 / high)});
  }
}

}  // namespace

std::vector<BranchOutcome> solve_branches(DesignProblem const& problem, std::vector<DesignBranch> const& branches) {
  throw_if_interrupted();
  std::vector<BranchOutcome> outcomes(branches.size());
  parallel_for(branches.size(), [&](std::size_t i) {
    DesignProblem const whole = complete(problem, branches[i]);
    BranchOutcome& outcome = outcomes[i];
    outcome.branch = branches[i];
    if (auto const bound = excluded_by(whole, branches[i])) {
      outcome.skipped = true;
      outcome.solution.worst = *bound;
    } else {
      outcome.solution = solve(whole, branches[i]);
    }
  });
  std::stable_sort(outcomes.begin(), outcomes.end(), [](BranchOutcome const& a, BranchOutcome const& b) {
    if (a.solution.feasible() != b.solution.feasible()) return a.solution.feasible();
    return a.solution.feasible() ? a.solution.objective < b.solution.objective
                                 : a.solution.violation < b.solution.violation;
  });
  return outcomes;
}

bool any_feasible(DesignProblem const& problem, std::vector<DesignBranch> const& branches) {
  throw_if_interrupted();
  std::atomic<bool> found = false;
  parallel_for(branches.size(), [&](std::size_t i) {
    if (found) return;
    DesignProblem const whole = complete(problem, branches[i]);
    if (!excluded_by(whole, branches[i]) && least_violation(whole, branches[i]).feasible()) found = true;
  });
  return found;
}

Recommendation recommend(Objective objective, std::vector<Limit> const& required,
                         std::vector<DesignBranch> const& branches) {
  DesignProblem const problem{objective, required};
  Recommendation answer;
  answer.outcomes = solve_branches(problem, branches);
  if (answer.feasible()) {
    answer.binding = binding_of(problem, answer.outcomes.front());
    add_costs(answer, problem, branches);
  } else {
    add_relaxations(answer, problem, smallest_conflict(problem, branches), branches);
  }
  return answer;
}

}  // namespace gladstone
