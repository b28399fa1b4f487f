#include "studies/compare/stereo_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/stereo/residual_validation.h"
#include "render/base/units.h"

namespace gladstone::inline compare {
namespace {

/// Each function returns nullopt if there is nothing to report.
std::optional<Warning> describe_small_angle(StereoMeasurement const& measurement) {
  constexpr double least_angle = 20 * unit::degree;
  if (measurement.view_angle >= least_angle) return {};
  return Warning{WarningCode::unsuitable, "",
                 fmt::format("the angle between the views is {:.1f} degrees: the third component is {:.1f} times less "
                             "certain than the others; 60 to 90 degrees are best",
                             measurement.view_angle / unit::degree, 1.0 / std::tan(0.5 * measurement.view_angle))};
}

std::optional<Warning> describe_unfinished_alignment(StereoMeasurement const& measurement) {
  if (!measurement.alignment || measurement.alignment->has_converged()) return {};
  return Warning{
      WarningCode::low_accuracy, "",
      fmt::format(
          "the position of the laser sheet has not converged (the residual disparity is {:.2f} px), so that the given "
          "plane is used; use more images, or start closer to the sheet with --sheet-z and --sheet-slope",
          measurement.alignment->disparity_px.back())};
}

std::optional<Warning> describe_displaced_sheet(StereoMeasurement const& measurement) {
  constexpr double least_px = 0.5;
  if (!measurement.given_sheet) return {};
  stereo::SheetAlignment const& sheet = *measurement.given_sheet;
  double const disparity_px = sheet.disparity_px.front();
  if (!(disparity_px > least_px && sheet.is_significant())) return {};
  return Warning{
      WarningCode::inconsistent, "",
      fmt::format(
          "disparity of {:.2f} px between the images of the two cameras: the laser sheet is displaced by {:.3f} mm at "
          "X = Y = 0 from the assumed plane, so that the cameras measure at different places; use --align",
          disparity_px, (sheet.fit.plane.height - measurement.field.plane.height) / unit::mm)};
}

std::optional<Warning> describe_rejected_vectors(StereoMeasurement const& measurement) {
  constexpr double least_fraction = 0.01;
  auto const determined = std::count_if(measurement.field.nodes.begin(), measurement.field.nodes.end(),
                                        [](auto const& node) { return node.has_value(); });
  double const fraction =
      static_cast<double>(stereo::count_rejected(measurement.field)) / static_cast<double>(determined);
  if (!(fraction > least_fraction)) return {};
  return Warning{WarningCode::unreliable, "",
                 fmt::format("{:.1f} % of the vectors are rejected, because the two cameras disagree by more than the "
                             "limit of the residual (--residual-limit): vectors of a camera are wrong (noise, too few "
                             "particles), the laser sheet is not in the assumed plane (try --align), or the "
                             "calibration has changed; errors within the plane of the lines of sight remain undetected",
                             100.0 * fraction)};
}

std::optional<Warning> describe_missing_uncertainty(StereoMeasurement const& measurement) {
  bool const any = std::any_of(measurement.field.nodes.begin(), measurement.field.nodes.end(),
                               [](auto const& node) { return node && std::isfinite(node->covariance[0]); });
  if (any) return {};
  return Warning{WarningCode::incomplete, "",
                 "the vectors have no uncertainty, so that the three components have none; correlate both cameras with "
                 "an uncertainty method, e.g. --set correlate.uncertainty=correlation_statistics"};
}

std::optional<Warning> describe_disagreement(StereoMeasurement const& measurement) {
  constexpr double largest_ratio = 2.0;
  double const ratio = compute_residual_ratio(measurement.field);
  if (!(ratio > largest_ratio)) return {};
  return Warning{
      WarningCode::unreliable, "",
      fmt::format(
          "the vectors of the two cameras disagree {:.1f} times more than their uncertainty explains: the laser sheet "
          "is not in the assumed plane (try --align), the calibration has changed, or vectors are wrong",
          ratio)};
}

}  // namespace

Warnings find_stereo_warnings(StereoMeasurement const& measurement) {
  Warnings warnings;
  for (auto const& describe : {describe_small_angle, describe_unfinished_alignment, describe_displaced_sheet,
                               describe_rejected_vectors, describe_missing_uncertainty, describe_disagreement})
    if (auto const warning = describe(measurement)) warnings.push_back(*warning);
  return warnings;
}

}  // namespace gladstone::inline compare
