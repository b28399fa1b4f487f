#include "studies/design/answer_text.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/design/bos_sheet.h"
#include "studies/design/recommendation_text.h"
#include "studies/design/sheet.h"
#include "studies/design/verification_text.h"

namespace gladstone::inline design {
namespace {

using Json = nlohmann::ordered_json;
using unit::mm;
constexpr std::size_t most_alternatives = 5;

/// A predicted quantity with its key.
struct Predicted {
  char const* key;
  double value;  ///< value in the unit of the key
};

std::vector<Predicted> predicted(DesignPoint<double> const& b) {
  return {{"sensitivity_px_per_kg_m4", b.sensitivity()},
          {"gradient_min_kg_m4", b.smallest_gradient()},
          {"random_px", b.random_error()},
          {"resolution_mm", resolved_wavelength(b) / mm},
          {"cone_diameter_mm", b.cone_diameter() / mm},
          {"window_width_mm", b.window_width() / mm},
          {"field_of_view_width_mm", b.given->camera.columns * b.pixel_at_medium() / mm},
          {"field_of_view_height_mm", b.given->camera.rows * b.pixel_at_medium() / mm},
          {"displacement_px", b.largest_displacement_px()},
          {"dot_image_px", b.dot_image_px()},
          {"peak_electrons", b.peak_electrons()},
          {"noise_to_peak", b.noise()},
          {"z_total_mm", b.z_b() / mm}};
}

/// Returns the recommended value of every free key, in the unit of the key.
std::vector<std::pair<std::string, double>> recommended(DesignQuestion const& question, DesignPoint<double> const& b) {
  std::array<double, choice_count> const value{b.focal_length, b.f_number, b.z_a, b.z_d, b.dot_diameter};
  std::vector<std::pair<std::string, double>> keys;
  for (FreeChoice const& free : question.free) {
    ChoiceKey const& key = choice_key(free.choice);
    keys.emplace_back(key.path, value[static_cast<std::size_t>(free.choice)] / key.unit);
  }
  return keys;
}

double required_value(AnsweredQuestion const& answered, Bound const* bound) {
  for (Limit const& limit : answered.question.requirements.limits) {
    if (limit.bound == bound) return limit.value / bound->unit;
  }
  return NAN;
}

std::string outcome_text(AnsweredQuestion const& answered, BranchOutcome const& outcome) {
  return fmt::format("    {}: {}\n", branch_name(outcome.branch, answered.variants, answered.question),
                     outcome_verdict(answered, outcome));
}

std::string feasible_text(AnsweredQuestion const& answered) {
  DesignPoint<double> const best = answered.best();
  std::string text = recommendation_text(answered) + "values of the free keys\n";
  for (auto const& [key, value] : recommended(answered.question, best)) {
    text += fmt::format("  {:<28}{:.6g}\n", key, value);
  }
  DesignVariant const& variant = answered.variants[answered.chosen().branch.variant];
  if (!variant.camera.empty()) text += fmt::format("  {:<28}{}\n", "camera", variant.camera);
  if (!variant.lens.empty()) text += fmt::format("  {:<28}{}\n", "lens", variant.lens);
  text += "predicted by formula\n";
  for (Predicted const& one : predicted(best)) text += fmt::format("  {:<28}{:.6g}\n", one.key, one.value);
  if (std::string const beyond = beyond_study(best); !beyond.empty()) {
    text +=
        "  random_px and gradient_min_kg_m4 are outside the range of the study of the random error: " + beyond + '\n';
  }
  text += "binding constraints\n";
  for (std::string const& name : answered.answer.binding) text += "  " + name + '\n';
  if (answered.answer.binding.empty()) text += "  nothing\n";
  text += fmt::format("cost of each requirement: change of {} if it is 1 % stricter\n", objective_word(answered));
  for (RequirementCost const& cost : answered.answer.costs) {
    text += fmt::format(
        "  {:<40}{}\n", cost.bound->name,
        std::isfinite(cost.change) ? fmt::format("{:+.2f} %", 100 * cost.change) : std::string("infeasible"));
  }
  return text;
}

std::string infeasible_text(AnsweredQuestion const& answered) {
  std::string text = "no feasible design: these requirements conflict\n";
  for (Bound const* const bound : answered.answer.conflicts) {
    text += fmt::format("  {} = {:.6g}\n", bound->name, required_value(answered, bound));
  }
  auto const add = [&](std::vector<Relaxation> const& relaxations) {
    for (Relaxation const& relaxation : relaxations) {
      text += fmt::format("  {} = {:.6g} instead of {:.6g}\n", relaxation.bound->name,
                          relaxation.value / relaxation.bound->unit, required_value(answered, relaxation.bound));
    }
  };
  if (auto const& nearest = answered.answer.without_requirements) {
    text +=
        "  the limits of the free keys and the constraints of every set-up, without any requirement; the closest "
        "set-up\n" +
        outcome_text(answered, *nearest);
    if (nearest->solution.worst == &below_full_well) {
      text += fmt::format("    {:.3g} times the light (radiance or exposure) would be sufficient\n",
                          std::exp(-nearest->solution.violation));
    }
  }
  if (!answered.answer.relaxations.empty())
    text += "relaxing one of these is sufficient, with everything else unchanged\n";
  add(answered.answer.relaxations);
  if (!answered.answer.together.empty()) text += "relaxing one of them is not sufficient; relaxing these together is\n";
  add(answered.answer.together);
  return text;
}

Json feasible_json(AnsweredQuestion const& answered) {
  Json json;
  DesignPoint<double> const best = answered.best();
  Recommendation const& answer = answered.answer;
  for (auto const& [key, value] : recommended(answered.question, best)) json["recommended"][key] = value;
  DesignVariant const& variant = answered.variants[answer.outcomes.front().branch.variant];
  if (!variant.camera.empty()) json["camera"] = variant.camera;
  if (!variant.lens.empty()) json["lens"] = variant.lens;
  for (Predicted const& one : predicted(best)) json["predicted"][one.key] = one.value;
  json["beyond_study"] = beyond_study(best);
  json["binding"] = answer.binding;
  json["costs"] = Json::array();
  for (RequirementCost const& cost : answer.costs) {
    json["costs"].push_back(
        {{"key", cost.bound->name}, {"change", std::isfinite(cost.change) ? Json(cost.change) : Json(nullptr)}});
  }
  json["front"] = Json::array();
  for (FrontPoint const& point : answer.front) {
    json["front"].push_back({{"key", answer.front_bound->name},
                             {"limit", point.limit / answer.front_bound->unit},
                             {"objective", written_objective(answered, point.objective)}});
  }
  return json;
}

}  // namespace

std::string answer_text(AnsweredQuestion const& answered) {
  std::string text = answered.answer.feasible() ? feasible_text(answered) : infeasible_text(answered);
  if (answered.verification) text += verification_text(*answered.verification, answered.question);
  text += fmt::format("combinations evaluated: {}, the best first\n", answered.answer.outcomes.size());
  for (std::size_t i = 0; i < std::min(most_alternatives, answered.answer.outcomes.size()); ++i) {
    text += outcome_text(answered, answered.answer.outcomes[i]);
  }
  std::map<std::string, int> skipped_by;
  for (BranchOutcome const& outcome : answered.answer.outcomes)
    if (outcome.skipped) ++skipped_by[outcome.solution.worst->name];
  for (auto const& [bound, count] : skipped_by) text += fmt::format("  {} skipped: {} excludes them\n", count, bound);
  for (SkippedVariant const& variant : answered.skipped) {
    text += fmt::format("  {}: skipped, incompatible with the setup: {}\n", variant.name(), variant.reason);
  }
  return text;
}

Json answer_json(AnsweredQuestion const& answered) {
  Recommendation const& answer = answered.answer;
  Json json = answer.feasible() ? feasible_json(answered) : Json::object();
  json["feasible"] = answered.feasible();
  json["objective"] = objective_keys[static_cast<std::size_t>(answered.question.requirements.objective)];
  if (answered.verification) json.update(verification_json(*answered.verification));
  json["conflicts"] = Json::array();
  for (Bound const* const bound : answer.conflicts) json["conflicts"].push_back(bound->name);
  for (auto const& [key, relaxations] :
       {std::pair{"relaxations", &answer.relaxations}, {"relaxations_together", &answer.together}}) {
    json[key] = Json::array();
    for (Relaxation const& relaxation : *relaxations) {
      json[key].push_back({{"key", relaxation.bound->name}, {"value", relaxation.value / relaxation.bound->unit}});
    }
  }
  if (auto const& nearest = answer.without_requirements) {
    bool const known = std::isfinite(nearest->solution.violation);
    json["without_requirements"] = {{"name", branch_name(nearest->branch, answered.variants, answered.question)},
                                    {"bound", nearest->solution.worst->name},
                                    {"excess", known ? Json(std::expm1(nearest->solution.violation)) : Json(nullptr)}};
  }
  json["choices"] = Json::array();
  for (BranchOutcome const& outcome : answer.outcomes) {
    bool const feasible = outcome.solution.feasible();
    json["choices"].push_back(
        {{"name", branch_name(outcome.branch, answered.variants, answered.question)},
         {"feasible", feasible},
         {"skipped", outcome.skipped},
         {"objective", feasible ? Json(written_objective(answered, outcome.solution.objective)) : Json(nullptr)},
         {"worst", outcome.solution.worst->name}});
  }
  json["skipped"] = Json::array();
  for (SkippedVariant const& variant : answered.skipped) {
    json["skipped"].push_back({{"name", variant.name()}, {"reason", variant.reason}});
  }
  return json;
}

}  // namespace gladstone::inline design
