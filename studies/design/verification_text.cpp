#include "studies/design/verification_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace gladstone::inline design {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string bench_text(VerifiedDesign const& one, DesignQuestion const& question) {
  std::string text = fmt::format("  {}{}\n", one.name, one.tightened ? ", for stricter limits" : "");
  DesignPoint<double> const bench = design_point_at(one.outcome.branch, one.outcome.solution.logarithms);
  std::array<double, choice_count> const value{bench.focal_length, bench.f_number, bench.z_a, bench.z_d,
                                               bench.dot_diameter};
  std::string place;
  for (FreeChoice const& free : question.free) {
    ChoiceKey const& key = choice_key(free.choice);
    place += fmt::format("{}{} {:.6g}", place.empty() ? "" : ", ", key.limit,
                         value[static_cast<std::size_t>(free.choice)] / key.unit);
  }
  text += "    " + place + '\n';
  if (!one.simulated.failed.empty()) return text + "    could not be simulated: " + one.simulated.failed + '\n';
  for (VerifiedQuantity const& quantity : one.quantities) {
    text += fmt::format("    {:<18}{:>12.5g} +- {:<9.2g}{:>12.5g} +- {:<9.2g}{}\n", quantity.key, quantity.predicted,
                        quantity.predicted_error, quantity.simulated.value, quantity.simulated.standard_error,
                        quantity.why);
  }
  for (VerifiedRequirement const& requirement : one.requirements) {
    if (requirement.kept()) continue;
    double const unit = requirement.bound->unit;
    text += fmt::format("    does not meet {} = {:.6g}: {:.5g} in simulation\n", requirement.bound->name,
                        requirement.required / unit, requirement.simulated.value / unit);
  }
  if (one.kept()) text += "    meets the requirements\n";
  return text;
}

Json quantities_json(VerifiedDesign const& one) {
  Json rows = Json::array();
  for (VerifiedQuantity const& quantity : one.quantities) {
    rows.push_back({{"key", quantity.key},
                    {"predicted", number(quantity.predicted)},
                    {"predicted_error", number(quantity.predicted_error)},
                    {"simulated", number(quantity.simulated.value)},
                    {"standard_error", number(quantity.simulated.standard_error)},
                    {"agrees", quantity.agrees()},
                    {"why", quantity.why}});
  }
  return rows;
}

Json requirements_json(VerifiedDesign const& one) {
  Json rows = Json::array();
  for (VerifiedRequirement const& requirement : one.requirements) {
    double const unit = requirement.bound->unit;
    rows.push_back({{"key", requirement.bound->name},
                    {"required", requirement.required / unit},
                    {"simulated", number(requirement.simulated.value / unit)},
                    {"standard_error", number(requirement.simulated.standard_error / unit)},
                    {"kept", requirement.kept()}});
  }
  return rows;
}

}  // namespace

std::string verification_text(Verification const& verification, DesignQuestion const& question) {
  if (verification.benches.empty()) return "";
  SimulatedDesign const& first = verification.benches.front().simulated;
  std::string text = fmt::format(
      "verified by rendering and correlating the middle {} x {} px, {} patterns of dots and noise\n"
      "    {:<18}{:>12} +- {:<9}{:>12} +- {:<9}{}\n",
      first.columns, first.rows, first.repeats, "", "predicted", "error", "simulated", "error",
      "cause of the difference");
  for (VerifiedDesign const& one : verification.benches) text += bench_text(one, question);
  if (!verification.any()) return text + "  none could be simulated: the recommendation is by the formulas only\n";
  if (!verification.chosen) {
    text += "  infeasible in simulation: no combination meets the requirements (--verify 0 uses the formulas only)\n";
  } else if (*verification.chosen > 0) {
    text += fmt::format("  recommended: {}, the best one that meets the requirements\n",
                        verification.benches[*verification.chosen].name);
  }
  return text;
}

Json verification_json(Verification const& verification) {
  Json json;
  if (verification.chosen) {
    VerifiedDesign const& chosen = verification.benches[*verification.chosen];
    for (VerifiedQuantity const& quantity : chosen.quantities) {
      json["simulated"][quantity.key] = number(quantity.simulated.value);
    }
  }
  json["verification"] = Json::array();
  for (VerifiedDesign const& one : verification.benches) {
    Json row{{"name", one.name}, {"tightened", one.tightened}};
    if (one.simulated.failed.empty()) {
      row["pixels"] = {one.simulated.columns, one.simulated.rows};
      row["repeats"] = one.simulated.repeats;
      row["vectors"] = one.simulated.vectors;
      row["quantities"] = quantities_json(one);
      row["requirements"] = requirements_json(one);
      row["causes"] = Json::array();
      for (SystematicCause const& cause : one.simulated.causes) {
        row["causes"].push_back({{"name", cause.name},
                                 {"predicted_px", number(cause.predicted)},
                                 {"simulated_px", number(cause.simulated)}});
      }
      row["kept"] = one.kept();
    } else {
      row["failed"] = one.simulated.failed;
    }
    json["verification"].push_back(std::move(row));
  }
  return json;
}

}  // namespace gladstone::inline design
