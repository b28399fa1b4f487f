#include "analysis/vectors/convention_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/vectors/convention_fit.h"

namespace gladstone::inline vectors {
namespace {

using Exchange = VectorConventions::Exchange;
using Mirror = VectorConventions::Mirror;
using Verdict = DetectedConventions::Verdict;

/// Returns the probable cause of vectors that no conventions fit.
std::string likely_cause(DetectedConventions const& detected) {
  if (detected.all_zero) return "all displacements are 0; the vectors were probably not computed";
  if (std::abs(detected.tried.front().slope) < 0.1)
    return "positions with another origin, or positions or displacements that are not in px, have this effect";
  return "positions with another origin have this effect";
}

std::string misfit_report(DetectedConventions const& detected) {
  ConventionFit const& best = detected.tried.front();
  std::string tried;
  for (ConventionFit const& fit : detected.tried) {
    if (fit.conventions.exchange != detected.conventions.exchange) continue;
    tried += fmt::format("{}{} {:.3g} px", tried.empty() ? "" : "; ", describe(fit.conventions), fit.rms_px);
  }
  return fmt::format(
      "{} vectors fit no convention: at best they differ from the truth by {:.3g} px rms, and the truth itself is "
      "{:.3g} px rms (they follow {:.0f} +- {:.0f} % of it). Tried, each with its best offset: {}; no exchange of "
      "columns, factor or shift fits either. {}; correct the file",
      detected.format, best.rms_px, best.signal_px, 100.0 * best.slope, 100.0 * best.slope_error, tried,
      likely_cause(detected));
}

std::string found_report(DetectedConventions const& detected) {
  ConventionFit const& fit = detected.fit;
  std::string report =
      fmt::format("{} vectors read as {} (rms difference from the truth {:.3g} px, rms of the truth {:.3g} px",
                  detected.format, describe(fit.conventions), fit.rms_px, fit.signal_px);
  auto const rival = std::find_if(detected.tried.begin(), detected.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, fit.conventions);
  });
  if (rival != detected.tried.end()) {
    report +=
        fmt::format("; the best other interpretation is {}: {:.3g} px", describe(rival->conventions), rival->rms_px);
  }
  report += ')';
  if (std::string const offset = offset_report(detected); !offset.empty()) report += "; " + offset;
  if (detected.verdict == Verdict::mistaken) {
    report += "; likely mistake: " + mistake_warning(detected.mistake);
  } else if (detected.verdict == Verdict::cannot_be_told && fit.signal_px >= min_decidable_signal_px) {
    report +=
        "; this displacement is too fine for windows of four grid spacings, so that vectors need not follow it: the "
        "conventions cannot be verified, and the format's own are used";
  } else if (detected.verdict == Verdict::cannot_be_told) {
    report += fmt::format(
        "; the displacement is below {} px, too small to verify the conventions, and the format's own are used",
        min_decidable_signal_px);
  } else if (detected.verdict == Verdict::noisy) {
    report += fmt::format(
        "; they differ from the truth by more than its rms, but follow {:.0f} +- {:.0f} % of it, like noisy vectors",
        100.0 * fit.slope, 100.0 * fit.slope_error);
  } else if (fit.slope < 0.5) {
    report += fmt::format(
        "; they follow only {:.2g} % of the true displacement: windows are far too large, or displacements are not in "
        "px",
        100.0 * fit.slope);
  }
  if (detected.ambiguous && detected.verdict != Verdict::cannot_be_told && detected.verdict != Verdict::mistaken)
    report +=
        "; another interpretation fits as well (this displacement does not distinguish them), and the format's own is "
        "used";
  return report;
}

std::string describe_factor(Vec2d factor) {
  if (std::isnan(factor.y))
    return fmt::format("u is {:.3g} times the truth (v is too small for an estimate)", factor.x);
  if (std::isnan(factor.x))
    return fmt::format("v is {:.3g} times the truth (u is too small for an estimate)", factor.y);
  if (factor.x == factor.y)
    return fmt::format("displacements are {:.3g} times the truth, as if in another unit than px", factor.x);
  return fmt::format("u is {:.3g} times and v {:.3g} times the truth", factor.x, factor.y);
}

std::string describe_offset(Vec2d offset_px) {
  auto const rounded = [](double value) { return 0.0 + std::round(1000.0 * value) / 1000.0; };
  return fmt::format("displacements are ({:.4g}, {:.4g}) px greater than the truth", rounded(offset_px.x),
                     rounded(offset_px.y));
}

/// Describes a shift of the positions, and names a component that the displacement does not determine.
std::string describe_shift(Vec2d shift_px, Vec2d uncertainty_px) {
  auto const digit = [](double uncertainty) { return uncertainty < 0.1 ? 0.01 : 0.1; };  // last digit [px]
  auto const rounded = [&](double value, double uncertainty) {
    return 0.0 + digit(uncertainty) * std::round(value / digit(uncertainty));
  };
  auto const along = [&](char axis, double value, double uncertainty, char other) {
    return fmt::format(
        "positions are shifted by {:.4g} px in {}, to within {:.2g} px (this displacement does not determine a shift "
        "in {})",
        rounded(value, uncertainty), axis, std::max(digit(uncertainty), uncertainty), other);
  };
  bool const x = uncertainty_px.x < max_shift_uncertainty_px, y = uncertainty_px.y < max_shift_uncertainty_px;
  if (x && !y) return along('x', shift_px.x, uncertainty_px.x, 'y');
  if (y && !x) return along('y', shift_px.y, uncertainty_px.y, 'x');
  double const larger = std::max(uncertainty_px.x, uncertainty_px.y);
  return fmt::format("positions are shifted by ({:.4g}, {:.4g}) px, each to within {:.2g} px",
                     rounded(shift_px.x, larger), rounded(shift_px.y, larger), std::max(digit(larger), larger));
}

}  // namespace

std::string convention_report(DetectedConventions const& detected) {
  return detected.verdict == Verdict::no_convention_fits ? misfit_report(detected) : found_report(detected);
}

std::string describe_difference(VectorConventions const& reading, VectorConventions const& own) {
  std::vector<std::string> parts;
  bool const y = reading.y_up != own.y_up, v = reading.v_up != own.v_up, frames = reading.swapped != own.swapped;
  auto const direction = [](bool up) { return up ? "up" : "down"; };
  if (reading.exchange != own.exchange) {
    parts.emplace_back(reading.exchange == Exchange::places       ? "x and y are exchanged"
                       : reading.exchange == Exchange::components ? "u and v are exchanged"
                                                                  : "the axes are exchanged (x with y, u with v)");
  }
  if (y && v && reading.y_up == reading.v_up) {
    parts.push_back(fmt::format("y and v point {}", direction(reading.y_up)));
  } else if (y) {
    parts.push_back(fmt::format("y points {}", direction(reading.y_up)));
  }
  if (frames && v && !y) {
    parts.emplace_back("u points left");
  } else {
    if (v && !(y && reading.y_up == reading.v_up)) parts.push_back(fmt::format("v points {}", direction(reading.v_up)));
    if (frames) parts.emplace_back("the frames were exchanged");
  }
  if (parts.empty() && reading.y_up && reading.mirror != own.mirror) {
    parts.emplace_back(reading.mirror == Mirror::image ? "y is counted from the last row of the image"
                                                       : "y is mirrored about the middle of the grid");
  }
  if (parts.empty() && reading.offset_px != own.offset_px) {
    double const moved = own.offset_px - reading.offset_px;
    parts.push_back(
        fmt::format("positions are {:.3g} px too far to the {}, as if pixels were counted from another origin",
                    std::abs(moved), moved > 0.0 ? "right and down" : "left and up"));
  }
  std::string text;
  for (std::string const& part : parts) text += (text.empty() ? "" : " and ") + part;
  return text;
}

std::string describe_reason(MistakeReason const& reason) {
  std::string const difference = describe_difference(reason.interpretation, reason.own);
  std::string const join = difference.empty() ? "" : " and ";
  switch (reason.kind) {
    case MistakeReason::Kind::interpretation:
      break;
    case MistakeReason::Kind::factor:
      return difference + join + describe_factor(reason.value);
    case MistakeReason::Kind::offset:
      return difference + join + describe_offset(reason.value);
    case MistakeReason::Kind::shift:
      return difference + join + describe_shift(reason.value, reason.uncertainty);
    case MistakeReason::Kind::position_factor:
      return difference + join +
             fmt::format("positions are {:.3g} times the true ones, as if in another unit than px", reason.value.x);
  }
  return difference;
}

std::string describe_mistake(ProbableMistake const& mistake) {
  std::string text;
  for (MistakeReason const& reason : mistake.reasons) text += (text.empty() ? "" : ", or ") + describe_reason(reason);
  return text;
}

std::string mistake_warning(ProbableMistake const& mistake) {
  std::string const remedy = mistake.conventions.empty()
                                 ? "correct the file"
                                 : "correct the file, or accept it with --conventions " + mistake.conventions;
  return fmt::format(
      "{} (the vectors differ from the truth by {:.3g} px rms as read, but by only {:.3g} px with this mistake "
      "undone); {}",
      describe_mistake(mistake), mistake.as_read.rms_px, mistake.corrected_fit.rms_px, remedy);
}

std::string offset_report(DetectedConventions const& detected) {
  double const offset = detected.conventions.offset_px;
  double const with = detected.fit.rms_px, without = detected.without_offset.rms_px;
  if (offset == 0.0) return {};
  std::string const moved = fmt::format("x {} {:.3g} px", offset < 0.0 ? '-' : '+', std::abs(offset));
  if (with < without) return fmt::format("{} fits better: rms {:.3g} instead of {:.3g} px", moved, with, without);
  return fmt::format("{} is the convention of the format and does not fit better: rms {:.3g}, without it {:.3g} px",
                     moved, with, without);
}

}  // namespace gladstone::inline vectors
