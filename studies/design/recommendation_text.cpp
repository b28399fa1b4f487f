#include "studies/design/recommendation_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/base/units.h"

namespace gladstone::inline design {
namespace {

using unit::mm;

constexpr auto f_number_index = static_cast<std::size_t>(Choice::f_number);

std::size_t objective_index(AnsweredQuestion const& answered) {
  return static_cast<std::size_t>(answered.question.requirements.objective);
}

std::string objective_text(AnsweredQuestion const& answered, double objective) {
  return fmt::format("{} {:.5g} {}", objective_word(answered), written_objective(answered, objective),
                     objective_units[objective_index(answered)]);
}

/// Returns the change of the objective relative to the recommended one, " (+3.1 %)".
std::string change_text(AnsweredQuestion const& answered, double objective) {
  return fmt::format(" ({:+.2g} %)", 100 * (objective / answered.chosen().solution.objective - 1));
}

/// Returns the free key f_number, if it is one.
FreeChoice const* free_stop(AnsweredQuestion const& answered) {
  std::vector<FreeChoice> const& free = answered.question.free;
  auto const found =
      std::find_if(free.begin(), free.end(), [](FreeChoice const& one) { return one.choice == Choice::f_number; });
  return found == free.end() ? nullptr : &*found;
}

bool differ_in_stop_only(DesignBranch const& a, DesignBranch const& b) {
  if (a.variant != b.variant || a.value[f_number_index] == b.value[f_number_index]) return false;
  for (std::size_t i = 0; i < choice_count; ++i) {
    if (i != f_number_index && a.value[i] != b.value[i]) return false;
  }
  return true;
}

enum class Direction { smaller, larger };

/// Describes the result for the next f-number among the admissible values; empty if there is none.
std::string listed_stop_text(AnsweredQuestion const& answered, Direction direction) {
  BranchOutcome const& chosen = answered.chosen();
  double const own = chosen.branch.value[f_number_index];
  BranchOutcome const* next = nullptr;
  for (BranchOutcome const& other : answered.answer.outcomes) {
    if (!differ_in_stop_only(chosen.branch, other.branch)) continue;
    double const there = other.branch.value[f_number_index];
    if ((there > own) != (direction == Direction::larger)) continue;
    if (!next || std::abs(there - own) < std::abs(next->branch.value[f_number_index] - own)) next = &other;
  }
  if (!next) return "";
  std::string const verdict = outcome_verdict(answered, *next);
  return fmt::format("f/{:.4g}: {}{}", next->branch.value[f_number_index], verdict,
                     next->solution.feasible() ? change_text(answered, next->solution.objective) : "");
}

/// Describes the result for the set-up with a stop larger or smaller by a factor sqrt(2) and everything else unchanged.
std::string full_stop_text(AnsweredQuestion const& answered, Direction direction, FreeChoice const* free) {
  DesignPoint<double> bench = answered.best();
  bench.f_number *= direction == Direction::larger ? std::sqrt(2.0) : std::sqrt(0.5);
  std::string const name = fmt::format("f/{:.4g}", bench.f_number);
  if (!free) return name + ": lens.f_number is not a free key";
  if (bench.f_number < free->low || bench.f_number > free->high) return name + ": is outside limits.f_number";
  std::vector<Limit> limits = answered.question.requirements.limits;
  std::vector<Limit> const feasible = feasibility_limits(*bench.given);
  limits.insert(limits.end(), feasible.begin(), feasible.end());
  double worst = -HUGE_VAL;
  Bound const* bound = &in_focus;
  for (Limit const& limit : limits) {
    double const here = excess(limit, bench);
    if (here > worst) worst = here, bound = limit.bound;
  }
  if (worst > allowed_excess) return fmt::format("{}: {}", name, describe_violation(*bound, worst));
  double const objective = objective_value(answered.question.requirements.objective, bench, bench);
  return fmt::format("{}: {}{}", name, objective_text(answered, objective), change_text(answered, objective));
}

std::string stop_text(AnsweredQuestion const& answered, Direction direction) {
  FreeChoice const* const free = free_stop(answered);
  if (free && !free->values.empty()) return listed_stop_text(answered, direction);
  return full_stop_text(answered, direction, free);
}

/// Returns the simulated random error of the recommended set-up [px]; nullopt: not simulated.
std::optional<double> simulated_error(AnsweredQuestion const& answered) {
  if (!answered.verification || !answered.verification->chosen) return std::nullopt;
  for (VerifiedQuantity const& quantity : answered.verification->benches[*answered.verification->chosen].quantities) {
    if (quantity.key == "random_px" && std::isfinite(quantity.simulated.value)) return quantity.simulated.value;
  }
  return std::nullopt;
}

}  // namespace

char const* objective_word(AnsweredQuestion const& answered) { return objective_words[objective_index(answered)]; }

double written_objective(AnsweredQuestion const& answered, double objective) {
  return objective / objective_scales[objective_index(answered)];
}

std::string outcome_verdict(AnsweredQuestion const& answered, BranchOutcome const& outcome) {
  BranchSolution const& solution = outcome.solution;
  if (outcome.skipped) return fmt::format("skipped, {} excludes it", solution.worst->name);
  return solution.feasible() ? objective_text(answered, solution.objective)
                             : describe_violation(*solution.worst, solution.violation);
}

std::string recommendation_text(AnsweredQuestion const& answered) {
  DesignPoint<double> const best = answered.best();
  DesignVariant const& variant = answered.variants[answered.chosen().branch.variant];
  std::string text = "recommended set-up\n";
  auto const line = [&text](char const* name, std::string const& value) {
    text += fmt::format("  {:<23}{}\n", name, value);
  };
  std::string parts = variant.lens.empty() ? "" : ", " + variant.lens;
  if (!variant.camera.empty()) parts += ", camera " + variant.camera;
  line("lens", fmt::format("{:.5g} mm{}", best.focal_length / mm, parts));
  line("stop", fmt::format("f/{:.4g}", best.f_number));
  line("target distance", fmt::format("{:.5g} mm from the dots to the medium, {:.5g} mm from there to the lens",
                                      best.z_d / mm, best.z_a / mm));
  line("dots", fmt::format("{:.4g} mm on the target, {:.3g} px in the image ({:.3g} px with diffraction)",
                           best.dot_diameter / mm, best.geometric_dot_px(), best.dot_image_px()));
  auto const simulated = simulated_error(answered);
  line("measures", fmt::format("density gradients from {:.4g} kg/m^4 on; random error {:.3g} px by formula{}",
                               best.smallest_gradient(), best.random_error(),
                               simulated ? fmt::format(", {:.3g} px simulated", *simulated) : ""));
  if (std::string const larger = stop_text(answered, Direction::larger); !larger.empty()) {
    line("next larger f-number", larger);
  }
  if (std::string const smaller = stop_text(answered, Direction::smaller); !smaller.empty()) {
    line("next smaller f-number", smaller);
  }
  return text;
}

}  // namespace gladstone::inline design
