#include "studies/design/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/progress.h"

namespace gladstone::inline design {
namespace {

using unit::mm;
constexpr double coverage = 2;  ///< admissible difference of two numbers, in standard errors
/// Relative accuracy of the random-error formula with respect to its study, and of the closed forms because of
/// neglected higher orders (docs/design.md).
constexpr double random_error_accuracy = 0.2, closed_form_accuracy = 0.02;

/// Minimum fraction of a difference that a cause must account for to be named as its reason.
constexpr double least_explained = 0.5;

/// Returns the cause with the largest difference between simulation and prediction, if it accounts for the total
/// difference.
std::string why_biased(SimulatedDesign const& simulated) {
  SystematicCause const* farthest = nullptr;
  auto const off = [](SystematicCause const& cause) { return std::abs(cause.simulated - cause.predicted); };
  for (SystematicCause const& cause : simulated.causes) {
    if (std::isfinite(off(cause)) && (!farthest || off(cause) > off(*farthest))) farthest = &cause;
  }
  if (!farthest) return "cause unknown";
  double const difference = std::abs(simulated.bias_px.value - simulated.predicted_bias_px);
  if (off(*farthest) < least_explained * difference) {
    return fmt::format("the cause with the largest deviation is {}, {:.2g} px; the rest is due to the estimator",
                       farthest->name, off(*farthest));
  }
  std::string text = fmt::format("{}: {:.3g} px", farthest->name, farthest->simulated);
  if (farthest->predicted == 0) return text + ", which no formula includes";
  text += fmt::format(" instead of {:.3g} px", farthest->predicted);
  bool const less = farthest->simulated < farthest->predicted;
  if (farthest->name == "window") {
    text += less ? " (passes that deform the images recover part of it)" : " (correlation is not an average)";
  }
  return text;
}

/// Returns the stage of the wave's transfer that deviates most from its formula, and its actual value.
std::string why_resolved(SimulatedDesign const& simulated, DesignPoint<double> const& bench) {
  WaveShares const& wave = simulated.waves.front();
  double const cone = cone_transfer(bench.pupil(), bench.z_b(), bench.z_d, bench.given->thickness, wave.wavelength) *
                      disc_transfer(bench.dot_diameter * bench.z_a / bench.z_b(), wave.wavelength);
  double const window = bench.given->window.share(bench.pixel_at_medium() / wave.wavelength);
  struct Share {
    char const* name;
    double simulated, predicted;
    char const* because;
  };
  std::vector<Share> const shares{
      {"cone", wave.cone, cone, "the field varies over its thickness"},
      {"refraction", wave.refraction / wave.cone, 1, "the stop transmits different rays in the measurement image"},
      {"aberration", wave.lens / wave.refraction, 1, "the lens is not ideal"},
      {"window", wave.measured.value / wave.lens, window, "passes that deform the images recover part of it"}};
  auto const farthest = std::max_element(shares.begin(), shares.end(), [](Share const& a, Share const& b) {
    return std::abs(a.simulated - a.predicted) < std::abs(b.simulated - b.predicted);
  });
  return fmt::format("{}: amplitude transfer of {:.3f} instead of {:.3f} at a wavelength of {:.4g} mm ({})",
                     farthest->name, farthest->simulated, farthest->predicted, wave.wavelength / mm, farthest->because);
}

/// Largest displacement, of either sign, in the study of the formula, which covers all sub-pixel fractions [px].
constexpr double studied_displacement_px = 0.5;

std::string why_random(SimulatedDesign const& simulated) {
  if (simulated.displacement_px < studied_displacement_px) {
    return fmt::format(
        "the largest displacement is only {:.2g} px, while the formula is a mean over all sub-pixel fractions",
        simulated.displacement_px);
  }
  return "noise, dots or strain differ from those in the study of the formula";
}

std::string why_lit(DesignPoint<double> const& bench) {
  bool const automatic = !bench.given->light && !bench.given->camera.exposure_e;
  return automatic ? "exposure = \"auto\" depends on the brightest pixel, where dots are close together"
                   : "light of neighbouring dots, or vignetting";
}

VerifiedDesign simulated_bench(DesignQuestion const& question, std::vector<DesignVariant> const& variants,
                               BranchOutcome const& outcome, VerificationPlan const& plan, CaseRunner& runner,
                               std::string const& device, Progress& progress) {
  VerifiedDesign verified;
  verified.outcome = outcome;
  verified.name = branch_name(outcome.branch, variants, question);
  DesignPoint<double> const bench = design_point_at(outcome.branch, outcome.solution.logarithms);
  std::size_t cases = 0;
  auto const finished = [&] {
    ++cases;
    progress.advance();
  };
  try {
    verified.simulated = simulate(applied_setup(variants[outcome.branch.variant], question, bench), bench, plan.repeats,
                                  plan.seed, runner, device, finished);
  } catch (SetupError const& error) {
    verified.simulated.failed = error.what();
  } catch (DataError const& error) {
    verified.simulated.failed = error.what();
  }
  progress.advance(simulated_cases(plan.repeats) - cases);
  compare_with_formulas(verified, question.requirements.limits);
  return verified;
}

/// Tightens the limits that were missed by the ratio of simulation to prediction.
std::vector<Limit> tightened(std::vector<Limit> limits, VerifiedDesign const& missed) {
  for (VerifiedRequirement const& requirement : missed.requirements) {
    if (requirement.kept()) continue;
    for (Limit& limit : limits) {
      if (limit.bound == requirement.bound) limit.value *= requirement.predicted / requirement.simulated.value;
    }
  }
  return limits;
}

}  // namespace

bool VerifiedQuantity::agrees() const {
  double const found_error = std::isfinite(simulated.standard_error) ? simulated.standard_error : 0;
  if (!rms) return std::abs(simulated.value - predicted) <= coverage * std::hypot(predicted_error, found_error);
  auto const square_error = [](double value, double error) { return error * (2 * value + error); };
  double const difference = simulated.value * simulated.value - predicted * predicted;
  return std::abs(difference) <=
         coverage * std::hypot(square_error(predicted, predicted_error), square_error(simulated.value, found_error));
}

bool VerifiedRequirement::kept() const {
  double const slack = coverage * simulated.standard_error + 1e-6 * required;
  return bound->from_below ? simulated.value >= required - slack : simulated.value <= required + slack;
}

bool VerifiedDesign::kept() const {
  return simulated.failed.empty() && std::all_of(requirements.begin(), requirements.end(),
                                                 [](VerifiedRequirement const& one) { return one.kept(); });
}

bool Verification::any() const {
  return std::any_of(benches.begin(), benches.end(),
                     [](VerifiedDesign const& one) { return one.simulated.failed.empty(); });
}

void compare_with_formulas(VerifiedDesign& verified, std::vector<Limit> const& required) {
  SimulatedDesign const& simulated = verified.simulated;
  if (!simulated.failed.empty()) return;
  DesignPoint<double> const bench = design_point_at(verified.outcome.branch, verified.outcome.solution.logarithms);
  auto const add = [&](char const* key, double predicted, double accuracy, Estimate found, double unit,
                       std::string const& why, bool rms = false) {
    VerifiedQuantity quantity{key,
                              predicted / unit,
                              accuracy * std::abs(predicted) / unit,
                              {found.value / unit, found.standard_error / unit},
                              rms,
                              why};
    if (quantity.agrees()) quantity.why.clear();
    verified.quantities.push_back(std::move(quantity));
  };
  add("random_px", bench.random_error(), random_error_accuracy, simulated.random_px, 1, why_random(simulated));
  add("bias_px", simulated.predicted_bias_px, closed_form_accuracy, simulated.bias_px, 1, why_biased(simulated), true);
  add("resolution_mm", resolved_wavelength(bench), closed_form_accuracy, simulated.resolution, mm,
      std::isfinite(simulated.resolution.value) ? why_resolved(simulated, bench)
                                                : "the two waves cannot be distinguished");
  add("peak_electrons", bench.peak_electrons(), closed_form_accuracy, simulated.peak_electrons, 1, why_lit(bench));
  for (Limit const& limit : required) {
    if (!limit.bound->simulated) continue;
    auto const [predicted, found] = limit.bound->simulated(simulated, bench);
    verified.requirements.push_back({limit.bound, limit.value, predicted, found});
  }
}

Verification verify(DesignQuestion const& question, std::vector<DesignVariant> const& variants,
                    std::vector<DesignBranch> const& branches, Recommendation const& answer,
                    VerificationPlan const& plan, Backend device) {
  std::string const device_name = device.name();
  Verification verification;
  std::vector<BranchOutcome> best;
  for (BranchOutcome const& outcome : answer.outcomes) {
    if (outcome.solution.feasible() && best.size() < plan.benches) best.push_back(outcome);
  }
  BranchOutcome const& first = answer.outcomes.front();
  CaseRunner runner(std::move(device), Sharing::over_repeats,
                    compared_apart_px(design_point_at(first.branch, first.solution.logarithms)));
  Progress progress("verifying", best.size() * simulated_cases(plan.repeats));
  for (BranchOutcome const& outcome : best) {
    verification.benches.push_back(simulated_bench(question, variants, outcome, plan, runner, device_name, progress));
    if (!verification.chosen && verification.benches.back().kept()) {
      verification.chosen = verification.benches.size() - 1;
    }
  }
  std::vector<Limit> limits = question.requirements.limits;
  std::optional<VerifiedDesign> missed;
  for (VerifiedDesign const& one : verification.benches) {
    if (!missed && one.simulated.failed.empty()) missed = one;
  }
  for (int round = 0; round < most_tightened && !verification.chosen && missed; ++round) {
    limits = tightened(std::move(limits), *missed);
    BranchOutcome const next = solve_branches({question.requirements.objective, limits}, branches).front();
    if (!next.solution.feasible()) break;
    Progress again("verifying stricter limits", simulated_cases(plan.repeats));
    VerifiedDesign& verified =
        verification.benches.emplace_back(simulated_bench(question, variants, next, plan, runner, device_name, again));
    verified.tightened = true;
    if (verified.kept()) verification.chosen = verification.benches.size() - 1;
    missed = verified;
  }
  return verification;
}

}  // namespace gladstone::inline design
