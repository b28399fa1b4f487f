#include "analysis/vectors/convention_detection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gladstone {
namespace {

using Mirror = VectorConventions::Mirror;
using Truth = std::function<Vec2d(Vec2d)>;
using Verdict = DetectedConventions::Verdict;

bool finite(Vec2d v) { return std::isfinite(v.x) && std::isfinite(v.y); }

/// Mirrored about the grid or about the image is a matter of position, like the offset, not of axes.
bool same_axes(VectorConventions const& a, VectorConventions const& b) {
  return a.y_up == b.y_up && a.v_up == b.v_up && a.swapped == b.swapped;
}

/// At most `most` vectors that count, evenly taken, with the extreme rows kept so that the grid's middle stays.
DisplacementField sample(DisplacementField const& field, std::size_t most) {
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.counts(i) && finite(field.displacement_px[i])) usable.push_back(i);
  }
  std::size_t const stride = std::max<std::size_t>(1, (usable.size() + most - 1) / most);
  DisplacementField few;
  auto const take = [&](std::size_t i, VectorStatus status) {
    few.position_px.push_back(field.position_px[i]);
    few.displacement_px.push_back(field.displacement_px[i]);
    few.status.push_back(status);
  };
  for (std::size_t k = 0; k < usable.size(); k += stride) take(usable[k], VectorStatus::valid);
  auto const by_y = [&](std::size_t a, std::size_t b) { return field.position_px[a].y < field.position_px[b].y; };
  std::vector<std::size_t> all(field.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  if (!all.empty()) {
    auto const [low, high] = std::minmax_element(all.begin(), all.end(), by_y);
    take(*low, VectorStatus::masked);  // counts for the extent only
    take(*high, VectorStatus::masked);
  }
  return few;
}

/// @param most that a difference counts as [px], and that a place without truth does, lest a choice win by moving its
///             vectors out of sight
ConventionFit fit_within(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                         int image_rows, double most) {
  DisplacementField const ours = apply_conventions(field, conventions, image_rows);
  double differences = 0.0, signal = 0.0, product = 0.0;
  std::size_t count = 0, known = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    Vec2d const t = truth(ours.position_px[i]);
    count += 2;
    if (!finite(t)) {
      differences += 2 * most * most;
      continue;
    }
    known += 2;
    for (auto const component : {&Vec2d::x, &Vec2d::y}) {
      double const e = std::clamp(ours.displacement_px[i].*component - t.*component, -most, most);
      differences += e * e;
      signal += t.*component * t.*component;
      product += (t.*component + e) * t.*component;
    }
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  ConventionFit fit{conventions, nan, nan, nan, nan};
  fit.components = count;
  if (count > 0) fit.rms_px = std::sqrt(differences / static_cast<double>(count));
  if (known > 0) fit.signal_px = std::sqrt(signal / static_cast<double>(known));
  if (signal > 0.0) {
    fit.slope = product / signal;
    // at an overlap of one half every vector shares its image with three others
    fit.slope_error = 2.0 * fit.rms_px / std::sqrt(signal);
  }
  return fit;
}

/// See ConventionFit::rms_px. What one wild vector adds is bounded, and yet misfits of large signals count in full.
double largest_difference(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                          int image_rows) {
  double const signal = fit_within(field, conventions, truth, image_rows, 1.0).signal_px;
  return std::isfinite(signal) ? std::max(1.0, 3.0 * signal) : 1.0;
}

/// Every choice, the format's own first, so that it wins a tie.
std::vector<VectorConventions> every_choice(VectorConventions const& own) {
  std::vector<VectorConventions> choices;
  auto const consider = [&choices](VectorConventions const& c) {
    if (std::find(choices.begin(), choices.end(), c) == choices.end()) choices.push_back(c);
  };
  for (double const offset : {own.offset_px, 0.0, -0.5, -1.0, -1.5}) {
    VectorConventions moved = own;
    moved.offset_px = offset;
    consider(moved);
    for (bool const swapped : {false, true}) {
      for (bool const v_up : {false, true}) {
        consider({false, v_up, swapped, offset, Mirror::grid});
        consider({true, v_up, swapped, offset, Mirror::grid});
        consider({true, v_up, swapped, offset, Mirror::image});
      }
    }
  }
  return choices;
}

/// Whether a fits better than b by more than chance: twice the logarithm of their likelihoods' ratio, of normal errors,
/// beyond 9 as three standard deviations are. At an overlap of one half every vector shares its image with three
/// others.
bool surely_better(ConventionFit const& a, ConventionFit const& b) {
  double const independent = 0.25 * static_cast<double>(a.components);
  return a.rms_px < b.rms_px && independent * 2.0 * std::log(b.rms_px / a.rms_px) > 9.0;
}

bool better(ConventionFit const& a, ConventionFit const& b) { return a.rms_px < b.rms_px; }

/// The best fit of each choice of axes and sign, the best first.
std::vector<ConventionFit> best_of_axes(std::vector<ConventionFit> const& fits) {
  std::vector<ConventionFit> best;
  for (ConventionFit const& fit : fits) {
    auto const known = std::find_if(best.begin(), best.end(), [&](ConventionFit const& other) {
      return same_axes(other.conventions, fit.conventions);
    });
    if (known == best.end()) {
      best.push_back(fit);
    } else if (better(fit, *known)) {
      *known = fit;
    }
  }
  std::stable_sort(best.begin(), best.end(), better);
  return best;
}

Verdict judge(ConventionFit const& best) {
  // three standard errors, since the best of some sixty choices is judged
  if (best.rms_px < best.signal_px && best.slope > 3.0 * best.slope_error) return Verdict::fits;
  if (!(best.signal_px >= telling_signal_px)) return Verdict::cannot_be_told;
  bool const follows = best.slope - 2.0 * best.slope_error > 0.5 && best.slope < 2.0;
  return follows ? Verdict::noisy : Verdict::fits_none;
}

/// x and y exchanged, in places alone or in displacements as well.
DisplacementField exchanged(DisplacementField field, bool displacements) {
  for (Vec2d& p : field.position_px) std::swap(p.x, p.y);
  if (displacements) {
    for (Vec2d& d : field.displacement_px) std::swap(d.x, d.y);
  }
  return field;
}

/// What may be the matter with vectors that fit no choice.
std::string likely_cause(DisplacementField const& field, std::vector<VectorConventions> const& choices,
                         ConventionFit const& best, Truth const& truth, int image_rows, double most) {
  for (bool const displacements : {false, true}) {
    DisplacementField const other = exchanged(field, displacements);
    for (VectorConventions const& choice : choices) {
      ConventionFit const fit = fit_within(other, choice, truth, image_rows, most);
      if (!(fit.rms_px < 0.5 * best.signal_px)) continue;
      return fmt::format("with {} exchanged they would fit to {:.3g} px rms",
                         displacements ? "x and y, u and v" : "x and y", fit.rms_px);
    }
  }
  if (std::abs(best.slope) < 0.1) {
    return "places from another origin, or places or displacements that are not in px, look like this";
  }
  if (best.slope > 2.0) return "displacements in another unit than px look like this";
  return "places from another origin look like this";
}

std::string misfit_report(VectorFile const& file, DetectedConventions const& detected, std::string const& cause) {
  ConventionFit const& best = detected.tried.front();
  std::string tried;
  for (ConventionFit const& fit : detected.tried) {
    tried += fmt::format("{}{} {:.3g} px", tried.empty() ? "" : "; ", describe(fit.conventions), fit.rms_px);
  }
  return fmt::format(
      "{} vectors fit no convention: at best they differ from the truth by {:.3g} px rms, where the truth itself is "
      "{:.3g} px rms (they follow {:.0f} +- {:.0f} % of it). Tried, each with its best offset: {}. {}; mend the file",
      file.format, best.rms_px, best.signal_px, 100.0 * best.slope, 100.0 * best.slope_error, tried, cause);
}

std::string found_report(VectorFile const& file, DetectedConventions const& detected) {
  ConventionFit const& fit = detected.fit;
  std::string report = fmt::format("{} vectors read as {} ({:.3g} px rms from the truth, which is {:.3g} px rms",
                                   file.format, describe(fit.conventions), fit.rms_px, fit.signal_px);
  auto const rival = std::find_if(detected.tried.begin(), detected.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, fit.conventions);
  });
  if (rival != detected.tried.end()) {
    report += fmt::format("; next best {}: {:.3g} px", describe(rival->conventions), rival->rms_px);
  }
  report += ')';
  if (std::string const offset = offset_report(detected); !offset.empty()) report += "; " + offset;
  if (detected.verdict == Verdict::cannot_be_told) {
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
  if (detected.ambiguous && detected.verdict != Verdict::cannot_be_told)
    report += "; another reading fits as well, and the format's own was kept";
  return report;
}

}  // namespace

ConventionFit fit_conventions(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                              int image_rows) {
  DisplacementField const few = sample(field, 4000);
  return fit_within(few, conventions, truth, image_rows, largest_difference(few, conventions, truth, image_rows));
}

DetectedConventions detect_conventions(VectorFile const& file, Truth const& truth, int image_rows) {
  DisplacementField const few = sample(file.field, 4000);
  VectorConventions const& own = file.conventions;
  double const most = largest_difference(few, own, truth, image_rows);
  std::vector<VectorConventions> const choices = every_choice(own);
  std::vector<ConventionFit> fits;
  for (VectorConventions const& choice : choices) fits.push_back(fit_within(few, choice, truth, image_rows, most));
  auto const with_offset = [&](VectorConventions c, double offset) {
    c.offset_px = offset;
    return *std::find_if(fits.begin(), fits.end(), [&](ConventionFit const& f) { return f.conventions == c; });
  };

  // Axes and sign by the best fit; the offset stays the format's own unless another is clearly better.
  ConventionFit const best = *std::min_element(fits.begin(), fits.end(), better);
  ConventionFit chosen = with_offset(best.conventions, own.offset_px);
  // Codes that deform images put their vectors where their grid says: what one pass of the same code has half a pixel
  // off is right after several. Which it was the file does not say.
  if (ConventionFit const plain = with_offset(best.conventions, 0.0); surely_better(plain, chosen)) chosen = plain;
  if (best.rms_px < 0.95 * chosen.rms_px) chosen = best;

  DetectedConventions result;
  result.verdict = judge(best);
  result.tried = best_of_axes(fits);
  auto const rival = std::find_if(result.tried.begin(), result.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, chosen.conventions);
  });
  result.ambiguous = !(chosen.rms_px < 0.9 * rival->rms_px);
  ConventionFit const fallback = with_offset(own, own.offset_px);
  if (result.verdict == Verdict::cannot_be_told || (result.ambiguous && !(fallback.rms_px > 1.1 * chosen.rms_px))) {
    chosen = fallback;
  }
  result.conventions = chosen.conventions;
  result.fit = chosen;
  result.without_offset = with_offset(chosen.conventions, 0.0);
  result.report = result.verdict == Verdict::fits_none
                      ? misfit_report(file, result, likely_cause(few, choices, best, truth, image_rows, most))
                      : found_report(file, result);
  return result;
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
