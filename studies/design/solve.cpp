#include "studies/design/solve.h"

#include <ceres/jet.h>

#include <algorithm>
#include <nlopt.hpp>

namespace gladstone::inline design {
namespace {

using Jet = ceres::Jet<double, choice_count>;

constexpr int candidates = 480;  // number of points from which the starting points are selected
constexpr std::size_t starts = 8;
constexpr std::size_t known_starts = 4;  // maximum number of starting points from known designs
// minimum distance of two starting points, relative to the length of the intervals
constexpr double apart = 0.1;
constexpr int most_evaluations = 300;
constexpr double tolerance = 1e-9;

/// A problem on a branch in the form that NLopt requires; with `slack`, the last variable is the allowed excess over
/// limits.
struct Task {
  DesignProblem const* problem;
  DesignBranch const* branch;
  bool slack;

  std::size_t own() const { return branch->continuous.size(); }

  DesignPoint<Jet> jets(double const* x) const {
    std::vector<Jet> variables;
    for (std::size_t i = 0; i < own(); ++i) variables.emplace_back(x[i], static_cast<int>(i));
    return design_point_at(*branch, variables);
  }
  DesignPoint<double> numbers(double const* x) const {
    return design_point_at(*branch, std::vector<double>(x, x + own()));
  }
};

void copy_derivatives(Jet const& value, std::size_t own, double* gradient) {
  for (std::size_t i = 0; i < own; ++i) gradient[i] = value.v[static_cast<Eigen::Index>(i)];
}

double evaluate_objective(unsigned n, double const* x, double* gradient, void* data) {
  auto const& task = *static_cast<Task const*>(data);
  if (task.slack) {
    if (gradient) {
      std::fill(gradient, gradient + n, 0.0);
      gradient[n - 1] = 1;
    }
    return x[n - 1];
  }
  DesignPoint<double> const here = task.numbers(x);
  double const lacking = excess({&in_focus, 0}, here);
  if (lacking > 0) {  // no image exists: minimize the excess instead
    if (gradient) copy_derivatives(excess({&in_focus, 0}, task.jets(x)), task.own(), gradient);
    return 100 + lacking;
  }
  if (!gradient) return std::log(objective_value(task.problem->objective, here, here));
  Jet const value = log(objective_value(task.problem->objective, task.jets(x), here));
  copy_derivatives(value, task.own(), gradient);
  return value.a;
}

void evaluate_limits(unsigned m, double* result, unsigned n, double const* x, double* gradient, void* data) {
  auto const& task = *static_cast<Task const*>(data);
  double const slack = task.slack ? x[n - 1] : 0;
  auto const& limits = task.problem->limits;
  if (!gradient) {
    DesignPoint<double> const here = task.numbers(x);
    for (unsigned i = 0; i < m; ++i) result[i] = excess(limits[i], here) - slack;
    return;
  }
  DesignPoint<Jet> const here = task.jets(x);
  for (unsigned i = 0; i < m; ++i) {
    Jet const value = excess(limits[i], here);
    result[i] = value.a - slack;
    copy_derivatives(value, task.own(), gradient + std::size_t{i} * n);
    if (task.slack) gradient[std::size_t{i} * n + n - 1] = -1;
  }
}

BranchSolution judged(DesignProblem const& problem, DesignBranch const& branch, std::vector<double> x) {
  x.resize(branch.continuous.size());
  DesignPoint<double> const bench = design_point_at(branch, x);
  BranchSolution solution;
  solution.violation = -HUGE_VAL;
  for (Limit const& limit : problem.limits) {
    double const by = excess(limit, bench);
    if (!(by > solution.violation) && !std::isnan(by)) continue;
    solution.violation = std::isnan(by) ? HUGE_VAL : by;
    solution.worst = limit.bound;
  }
  if (solution.feasible()) solution.objective = objective_value(problem.objective, bench, bench);
  solution.logarithms = std::move(x);
  return solution;
}

bool better(BranchSolution const& a, BranchSolution const& b) {
  if (a.feasible() != b.feasible()) return a.feasible();
  return a.feasible() ? a.objective < b.objective : a.violation < b.violation;
}

/// Returns a point of a low-discrepancy sequence over the intervals; the first is their centre.
std::vector<double> spread_point(DesignBranch const& branch, int index) {
  std::vector<double> x;
  for (std::size_t i = 0; i < branch.continuous.size(); ++i) {
    FreeChoice const& free = branch.continuous[i];
    // Kronecker sequence with powers of the root of x^6 = x + 1, which is uniform in five dimensions.
    double const turn = 0.5 + index * std::pow(1 / 1.1347241384015194, static_cast<double>(i + 1));
    double const share = turn - std::floor(turn);
    x.push_back(std::log(free.low) + share * std::log(free.high / free.low));
  }
  return x;
}

bool far_from(std::vector<BranchSolution> const& chosen, BranchSolution const& point, DesignBranch const& branch) {
  return std::none_of(chosen.begin(), chosen.end(), [&](BranchSolution const& other) {
    double distance = 0;
    for (std::size_t i = 0; i < branch.continuous.size(); ++i) {
      double const length = std::log(branch.continuous[i].high / branch.continuous[i].low);
      if (length > 0) distance = std::max(distance, std::abs(point.logarithms[i] - other.logarithms[i]) / length);
    }
    return distance < apart;
  });
}

/// Selects starting points, best first: the best of many points with a minimum distance from each other, so that narrow
/// feasible regions are found too, and the best known designs.
std::vector<BranchSolution> start_points(DesignProblem const& problem, DesignBranch const& branch,
                                         KnownDesigns const& known) {
  std::vector<BranchSolution> points, chosen, before;
  int const count = branch.continuous.empty() ? 1 : candidates;
  for (int i = 0; i < count; ++i) points.push_back(judged(problem, branch, spread_point(branch, i)));
  std::stable_sort(points.begin(), points.end(), better);
  for (BranchSolution const& point : points) {
    if (chosen.size() < starts && far_from(chosen, point, branch)) chosen.push_back(point);
  }
  for (std::vector<double> const& x : known) before.push_back(judged(problem, branch, x));
  std::stable_sort(before.begin(), before.end(), better);
  if (before.size() > known_starts) before.resize(known_starts);
  chosen.insert(chosen.end(), before.begin(), before.end());
  std::stable_sort(chosen.begin(), chosen.end(), better);
  return chosen;
}

std::vector<double> minimised(Task& task, std::vector<double> x) {
  std::size_t const n = task.own() + (task.slack ? 1 : 0);
  nlopt::opt optimizer(nlopt::LD_SLSQP, static_cast<unsigned>(n));
  std::vector<double> low, high;
  for (FreeChoice const& free : task.branch->continuous) {
    low.push_back(std::log(free.low));
    high.push_back(std::log(free.high));
  }
  if (task.slack) {
    low.push_back(-1e-3);
    high.push_back(HUGE_VAL);
    x.push_back(std::max(0.0, judged(*task.problem, *task.branch, x).violation));
  }
  optimizer.set_lower_bounds(low);
  optimizer.set_upper_bounds(high);
  optimizer.set_min_objective(evaluate_objective, &task);
  optimizer.add_inequality_mconstraint(evaluate_limits, &task,
                                       std::vector<double>(task.problem->limits.size(), tolerance));
  // Stop by the design variables alone: the slack stagnates at curved limits long before its minimum.
  optimizer.set_xtol_rel(1e-12);
  optimizer.set_maxeval(most_evaluations);
  double value = 0;
  try {
    optimizer.optimize(x, value);
  } catch (std::runtime_error const&) {
    // roundoff-limited: the current point is evaluated like any other
  }
  for (std::size_t i = 0; i < task.own(); ++i) x[i] = std::clamp(x[i], low[i], high[i]);
  return x;
}

}  // namespace

Bound const* excluded_by(DesignProblem const& problem, DesignBranch const& branch) {
  // View and image distance increase with both distances; their sum is smallest at the lower ends of the intervals.
  std::vector<double> least, most;
  for (FreeChoice const& free : branch.continuous) {
    bool const distance = free.choice == Choice::z_a || free.choice == Choice::z_d;
    bool const focal = free.choice == Choice::focal_length;
    least.push_back(std::log(distance ? free.low : free.high));
    most.push_back(std::log(distance ? free.high : focal ? free.low : free.high));
  }
  DesignPoint<double> const near = design_point_at(branch, least), far = design_point_at(branch, most);
  for (Limit const& limit : problem.limits) {
    using Extreme = Bound::Extreme;
    Extreme const extreme = limit.bound->extreme;
    if (extreme == Extreme::near && limit.bound->excess.value(limit.value, near) > allowed_excess) return limit.bound;
    if (extreme == Extreme::far && excess(limit, far) > allowed_excess) return limit.bound;
  }
  return nullptr;
}

BranchSolution least_violation(DesignProblem const& problem, DesignBranch const& branch, KnownDesigns const& known) {
  std::vector<BranchSolution> const points = start_points(problem, branch, known);
  BranchSolution best = points.front();
  for (BranchSolution const& start : points) {
    if (best.feasible() || branch.continuous.empty()) return best;
    // with and without slack variable: one may converge where the other does not
    for (bool const slack : {true, false}) {
      Task task{&problem, &branch, slack};
      BranchSolution const found = judged(problem, branch, minimised(task, start.logarithms));
      if (better(found, best)) best = found;
    }
  }
  return best;
}

BranchSolution solve(DesignProblem const& problem, DesignBranch const& branch, KnownDesigns const& known) {
  BranchSolution best = least_violation(problem, branch, known);
  if (!best.feasible() || branch.continuous.empty()) return best;
  std::vector<BranchSolution> points = start_points(problem, branch, known);
  points.push_back(best);
  if (better(points.front(), best)) best = points.front();
  for (BranchSolution const& start : points) {
    Task task{&problem, &branch, false};
    BranchSolution const found = judged(problem, branch, minimised(task, start.logarithms));
    if (better(found, best)) best = found;
  }
  return best;
}

}  // namespace gladstone::inline design
