#include "analysis/vectors/convention_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/scale_and_shift.h"

namespace gladstone {
namespace {

using Exchange = VectorConventions::Exchange;
using Mirror = VectorConventions::Mirror;
using Verdict = DetectedConventions::Verdict;

/// Returns a probable cause if no conventions fit.
std::string likely_cause(DisplacementField const& field, ConventionFit const& best) {
  if (detail::is_zero(field)) return "all displacements are 0, as of vectors that were not computed";
  if (std::abs(best.slope) < 0.1)
    return "places from another origin, or places or displacements that are not in px, look like this";
  return "places from another origin look like this";
}

}  // namespace

namespace detail {

std::string misfit_report(VectorFile const& file, DetectedConventions const& detected) {
  ConventionFit const& best = detected.tried.front();
  std::string tried;
  for (ConventionFit const& fit : detected.tried) {
    if (fit.conventions.exchange != detected.conventions.exchange) continue;
    tried += fmt::format("{}{} {:.3g} px", tried.empty() ? "" : "; ", describe(fit.conventions), fit.rms_px);
  }
  return fmt::format(
      "{} vectors fit no convention: at best they differ from the truth by {:.3g} px rms, where the truth itself is "
      "{:.3g} px rms (they follow {:.0f} +- {:.0f} % of it). Tried, each with its best offset: {}; no exchange of "
      "columns, factor or shift fits either. {}; mend the file",
      file.format, best.rms_px, best.signal_px, 100.0 * best.slope, 100.0 * best.slope_error, tried,
      likely_cause(file.field, best));
}

std::string found_report(VectorFile const& file, DetectedConventions const& detected) {
  ConventionFit const& fit = detected.fit;
  std::string report = fmt::format("{} vectors read as {} ({:.3g} px rms from the truth, which is {:.3g} px rms",
                                   file.format, describe(fit.conventions), fit.rms_px, fit.signal_px);
  auto const rival = std::find_if(detected.tried.begin(), detected.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, fit.conventions);
  });
  if (rival != detected.tried.end()) {
    report += fmt::format("; of other readings {} fits best: {:.3g} px", describe(rival->conventions), rival->rms_px);
  }
  report += ')';
  if (std::string const offset = offset_report(detected); !offset.empty()) report += "; " + offset;
  if (detected.verdict == Verdict::mistaken) {
    report += "; likely mistake: " + detected.mistake.warning();
  } else if (detected.verdict == Verdict::cannot_be_told && fit.signal_px >= telling_signal_px) {
    report +=
        "; this displacement is too fine for windows of four grid spacings, so that vectors need not follow it: "
        "conventions cannot be told, and the format's own were kept";
  } else if (detected.verdict == Verdict::cannot_be_told) {
    report += fmt::format(
        "; by so small a displacement, below {} px, conventions cannot be told, and the format's own were kept",
        telling_signal_px);
  } else if (detected.verdict == Verdict::noisy) {
    report += fmt::format(
        "; they differ from the truth by more than it is itself, but follow {:.0f} +- {:.0f} % of it, as noisy vectors "
        "do",
        100.0 * fit.slope, 100.0 * fit.slope_error);
  } else if (fit.slope < 0.5) {
    report += fmt::format(
        "; they follow {:.2g} % of the true displacement only, as far too large windows do, or "
        "displacements that are not in px",
        100.0 * fit.slope);
  }
  if (detected.ambiguous && detected.verdict != Verdict::cannot_be_told && detected.verdict != Verdict::mistaken)
    report +=
        "; another reading fits as well (this displacement cannot tell them apart), and the format's own was kept";
  return report;
}

}  // namespace detail

std::string difference_of(VectorConventions const& reading, VectorConventions const& own) {
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
    parts.emplace_back(reading.mirror == Mirror::image ? "y counts from the image's last row"
                                                       : "y is turned about the middle of the grid");
  }
  if (parts.empty() && reading.offset_px != own.offset_px) {
    double const moved = own.offset_px - reading.offset_px;
    parts.push_back(fmt::format("places lie {:.3g} px too far to the {}, as those of codes that count pixels otherwise",
                                std::abs(moved), moved > 0.0 ? "right and down" : "left and up"));
  }
  std::string text;
  for (std::string const& part : parts) text += (text.empty() ? "" : " and ") + part;
  return text;
}

std::string LikelyMistake::warning() const {
  std::string const remedy =
      conventions.empty() ? "mend the file" : "mend the file, or accept it with --conventions " + conventions;
  return fmt::format(
      "{} (without that they would differ from the truth by {:.3g} px rms, as they are read by {:.3g} "
      "px); {}",
      text, mended.rms_px, as_read.rms_px, remedy);
}

std::string offset_report(DetectedConventions const& detected) {
  double const offset = detected.conventions.offset_px;
  double const with = detected.fit.rms_px, without = detected.without_offset.rms_px;
  if (offset == 0.0) return {};
  std::string const moved = fmt::format("x {} {:.3g} px", offset < 0.0 ? '-' : '+', std::abs(offset));
  if (with < without) return fmt::format("{} fits better: rms {:.3g} instead of {:.3g} px", moved, with, without);
  return fmt::format("{} is the format's own and does not fit better: rms {:.3g}, without it {:.3g} px", moved, with,
                     without);
}

}  // namespace gladstone
