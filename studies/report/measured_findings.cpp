#include "studies/report/measured_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "analysis/errors/error_summary.h"
#include "studies/compare/uncorrected_bias.h"
#include "studies/design/input_draws.h"
#include "studies/design/measurement_inputs.h"

namespace gladstone::inline report {
namespace {

/// Returns the origin of the displacements' uncertainty.
std::string source_of_sigma(MeasuredGradients const& all) {
  if (all.estimated == all.count) return "the estimator's own, from the images";
  if (all.estimated == 0) return "by the formula of the random error (F26), since the vectors have none";
  return fmt::format(
      "the estimator's own, from the images, at {} vectors, and by the formula of the random error (F26) at {} that "
      "have none",
      all.estimated, all.count - all.estimated);
}

std::string degrees_text(double degrees) {
  if (!(degrees < 1e6)) return "infinite";
  return degrees < 100 ? fmt::format("{:.3g}", degrees) : fmt::format("{:.0f}", degrees);
}

std::string about_displacement(MeasurementKnown const& known) {
  if (known.mean.count == 1) {
    return fmt::format(
        "The uncertainty of the displacement is of type B: {}. There is no evaluation of type A, for which the "
        "measurement would have to be repeated (--repeats).",
        source_of_sigma(known.gradients));
  }
  return fmt::format(
      "The uncertainty of the displacement is of type A: the standard deviation of the mean of {} repeats, {:.3g} px "
      "rms over vectors and components, with {} degree{} of freedom at each of them. The type B estimate of the "
      "measurements themselves would be {:.3g} px in the median; it is not added. Errors common to all repeats do not "
      "scatter and are not included: for dots that were not moved, the error due to their pattern.",
      known.mean.count, known.inputs.front().sigma, known.mean.count - 1, known.mean.count == 2 ? "" : "s",
      known.mean.estimated_px);
}

std::string about_linearity(PropagatedResult const& typical) {
  if (typical.linear) return "First-order propagation is valid (JCGM 101:2008).";
  return fmt::format(
      "The propagation is not linear, or not normal: for a vector of typical displacement, of {:.4g} kg/m^4, use the "
      "interval that contains 95.45 % of the samples (JCGM 101:2008), from {:.4g} to {:.4g} kg/m^4.",
      typical.value, typical.sampled_low, typical.sampled_high);
}

std::string about_setup(MeasurementKnown const& known) {
  if (known.inputs.size() == 1) {
    return "No number of the setup has an uncertainty, { value = ..., sigma = ... }: distances, focal length, pixel "
           "pitch, K and thickness are assumed to be exact. " +
           about_linearity(known.typical);
  }
  std::vector<std::string> const pairs = correlation_texts(known.inputs);
  return fmt::format(
      "The uncertainties of the numbers of the setup are of type B, {}, and the same at all vectors: together {:.3g} % "
      "of the gradient. {}",
      pairs.empty() ? "assumed to be independent" : fmt::format("correlated ({})", fmt::join(pairs, "; ")),
      100 * known.gradients.common, about_linearity(known.typical));
}

std::string about_bias(MeasurementKnown const& known) {
  std::string const words = describe_uncorrected_bias(bos_comparison);
  if (!known.simulated()) return "The uncorrected bias is unknown without a simulated twin: " + words;
  double const bias_px = uncorrected_bias_px(known.twin->comparison);
  return fmt::format(
      "The uncorrected bias is {:.3g} px, {:.3g} kg/m^4, in the simulated twin, whose medium is the measured density: "
      "{} Structures finer than the measurement resolved are missing in the twin, so that the actual bias may be "
      "larger.",
      bias_px, bias_px / known.sensitivity, words);
}

}  // namespace

std::vector<std::string> MeasurementStatements::all() const { return {measurand, expanded, displacement, setup, bias}; }

MeasurementStatements measurement_statements(MeasurementKnown const& known) {
  std::vector<double> const combined = finite_components(known.gradients.combined);
  double const median = quantile(combined, 0.5);
  MeasurementStatements said;
  said.measurand = fmt::format(
      "The measurand is the density gradient, averaged over the thickness, at each of {} vectors: rms {:.4g} kg/m^4. "
      "Its combined standard uncertainty is {:.3g} kg/m^4 in the median of the components ({:.3g} to {:.3g} kg/m^4 for "
      "10 to 90 % of them).",
      known.gradients.count, compute_rms(finite_components(known.gradients.gradient)), median, quantile(combined, 0.1),
      quantile(combined, 0.9));
  PropagatedResult const& typical = known.typical;
  said.expanded = fmt::format(
      "The expanded uncertainty in the median is U = {:.3g} kg/m^4 = k u_c with a coverage factor k = {:.2f} "
      "(effective degrees of freedom {}) for a coverage probability of 95.45 %.",
      typical.coverage_factor * median, typical.coverage_factor, degrees_text(typical.degrees_of_freedom));
  said.displacement = about_displacement(known);
  said.setup = about_setup(known);
  said.bias = about_bias(known);
  return said;
}

TextTable inputs_table(MeasurementKnown const& known) {
  TextTable table{"Uncertainty budget of the gradient at a vector of typical displacement",
                  {"input", "type", "value", "standard uncertainty", "samples drawn from", "degrees of freedom",
                   "sensitivity coefficient [kg/m^4 per unit of the input]", "contribution to u(gradient) [kg/m^4]",
                   "share of the variance [%]"},
                  {}};
  for (std::size_t i = 0; i < known.inputs.size(); ++i) {
    MeasurementInput const& input = known.inputs[i];
    Contribution const& part = known.typical.contributions[i];
    bool const finite = std::isfinite(input.degrees_of_freedom);
    table.rows.push_back({{input.key},
                          {i == 0 && known.mean.count > 1 ? "A" : "B"},
                          TableCell::of(input.value),
                          TableCell::of(input.sigma),
                          {drawn_distribution(known.inputs, i)},
                          finite ? TableCell::of(input.degrees_of_freedom) : TableCell{"infinite"},
                          TableCell::of(part.derivative),
                          {fmt::format("{:.3g}", part.standard), part.standard},
                          {fmt::format("{:.1f}", 100 * part.share), 100 * part.share}});
  }
  return table;
}

}  // namespace gladstone::inline report
