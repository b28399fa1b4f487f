#include "analysis/vectors/convention_detection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gladstone {
namespace {

using Exchange = VectorConventions::Exchange;
using Mirror = VectorConventions::Mirror;
using Truth = std::function<Vec2d(Vec2d)>;
using Verdict = DetectedConventions::Verdict;

bool finite(Vec2d v) { return std::isfinite(v.x) && std::isfinite(v.y); }

/// Compares axes and signs. The mirror (grid or image) and the offset affect only the position.
bool same_axes(VectorConventions const& a, VectorConventions const& b) {
  return a.y_up == b.y_up && a.v_up == b.v_up && a.swapped == b.swapped && a.exchange == b.exchange;
}

/// Selects at most `most` counted vectors at equal index intervals. The rows with the extreme y are included as masked
/// vectors, so that the centre of the grid is preserved.
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
    take(*low, VectorStatus::masked);  // used only for the extent
    take(*high, VectorStatus::masked);
  }
  return few;
}

/// Computes the agreement with clamped differences.
/// @param most  upper limit of a difference [px], and the difference assumed at positions without truth, so that
///              conventions cannot win by moving vectors out of view
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
    // At an overlap of one half, every vector shares its image with three others.
    fit.slope_error = 2.0 * fit.rms_px / std::sqrt(signal);
  }
  return fit;
}

/// Returns the limit of ConventionFit::rms_px, which bounds the influence of outliers but preserves misfits of large
/// signals.
double largest_difference(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                          int image_rows) {
  double const signal = fit_within(field, conventions, truth, image_rows, 1.0).signal_px;
  return std::isfinite(signal) ? std::max(1.0, 3.0 * signal) : 1.0;
}

/// Returns all candidate conventions. The format's own come first, so that they win ties.
std::vector<VectorConventions> every_choice(std::vector<VectorConventions> const& own) {
  std::vector<VectorConventions> choices = own;
  auto const consider = [&choices](VectorConventions const& c) {
    if (std::find(choices.begin(), choices.end(), c) == choices.end()) choices.push_back(c);
  };
  auto const consider_axes = [&](VectorConventions reading) {
    for (bool const swapped : {false, true}) {
      for (bool const v_up : {false, true}) {
        for (auto const& [y_up, mirror] :
             {std::pair(false, Mirror::grid), std::pair(true, Mirror::grid), std::pair(true, Mirror::image)}) {
          reading.swapped = swapped;
          reading.v_up = v_up;
          reading.y_up = y_up;
          reading.mirror = mirror;
          consider(reading);
        }
      }
    }
  };
  VectorConventions reading = own.front();
  for (double const offset : {own.front().offset_px, 0.0, -0.5, -1.0, -1.5}) {
    reading.offset_px = offset;
    consider_axes(reading);
  }
  reading.offset_px = own.front().offset_px;
  for (auto const exchange : {Exchange::places, Exchange::components, Exchange::axes}) {
    reading.exchange = exchange;
    consider_axes(reading);
  }
  return choices;
}

bool surely_better(ConventionFit const& a, ConventionFit const& b) {
  return a.rms_px < b.rms_px && evidence_for(a, b) > 9.0;
}

bool better(ConventionFit const& a, ConventionFit const& b) { return a.rms_px < b.rms_px; }

/// Returns the best fit of each choice of axes and signs, in ascending order of rms.
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
  // Require three standard errors, since this is the best of some sixty candidates.
  if (best.rms_px < best.signal_px && best.slope > 3.0 * best.slope_error) return Verdict::fits;
  if (!(best.signal_px >= telling_signal_px)) return Verdict::cannot_be_told;
  bool const follows = best.slope - 2.0 * best.slope_error > 0.5 && best.slope < 2.0;
  return follows ? Verdict::noisy : Verdict::fits_none;
}

/// Returns the smallest unlikelihood relative to any of the format's own conventions.
double unlikelihood(VectorConventions const& reading, std::vector<VectorConventions> const& own) {
  double least = std::numeric_limits<double>::infinity();
  for (VectorConventions const& one : own) least = std::min(least, unlikelihood(reading, one));
  return least;
}

/// Returns true if the difference from the best fit is insignificant, or small enough to be caused by estimator errors
/// in a flow of similar appearance: 10 % of the rms for other axes, 5 % for another offset.
bool fits_as_well(ConventionFit const& fit, ConventionFit const& best) {
  double const part = same_axes(fit.conventions, best.conventions) ? 0.95 : 0.9;
  return !(part * fit.rms_px > best.rms_px) || evidence_for(best, fit) < 9.0;
}

/// Returns the likeliest of the conventions that fit as well as the best.
ConventionFit likeliest(std::vector<ConventionFit> const& fits, std::vector<VectorConventions> const& own) {
  ConventionFit const best = *std::min_element(fits.begin(), fits.end(), better);
  return *std::min_element(fits.begin(), fits.end(), [&](ConventionFit const& a, ConventionFit const& b) {
    auto const rank = [&](ConventionFit const& fit) {
      return fits_as_well(fit, best) ? unlikelihood(fit.conventions, own) : std::numeric_limits<double>::infinity();
    };
    return rank(a) < rank(b);
  });
}

/// Divides displacements by a factor and shifts positions.
DisplacementField changed(DisplacementField field, Vec2d factor, Vec2d shift) {
  for (Vec2d& d : field.displacement_px) d = {d.x / factor.x, d.y / factor.y};
  for (Vec2d& p : field.position_px) p += shift;
  return field;
}

/// Returns the factor between a component and its truth by least absolute deviations: the median of their ratios,
/// weighted by |truth|. It is robust to up to half of the vectors being wrong.
double median_factor(DisplacementField const& ours, Truth const& truth, double Vec2d::*component) {
  std::vector<std::pair<double, double>> ratios;
  double sum = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    double const t = truth(ours.position_px[i]).*component;
    if (!std::isfinite(t) || t == 0.0) continue;
    ratios.emplace_back(ours.displacement_px[i].*component / t, std::abs(t));
    sum += std::abs(t);
  }
  std::sort(ratios.begin(), ratios.end());
  double below = 0.0;
  for (auto const& [ratio, weight] : ratios) {
    below += weight;
    if (below >= 0.5 * sum) return ratio;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// Returns the rms of a component of the truth [px].
double component_signal(DisplacementField const& ours, Truth const& truth, double Vec2d::*component) {
  double square = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    double const t = ours.counts(i) ? truth(ours.position_px[i]).*component : std::nan("");
    if (!std::isfinite(t)) continue;
    square += t * t;
    ++count;
  }
  return count > 0 ? std::sqrt(square / static_cast<double>(count)) : 0.0;
}

/// Returns the regression slope, by component and at most 1, of the truth averaged over windows of 64 px on the truth
/// at the point.
Vec2d share_in_windows(DisplacementField const& ours, Truth const& truth) {
  constexpr int half = 32, step = 8;
  Vec2d product{}, square{};
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    Vec2d mean{};
    int count = 0;
    for (int dy = -half + step / 2; dy < half; dy += step) {
      for (int dx = -half + step / 2; dx < half; dx += step) {
        Vec2d const t = truth(ours.position_px[i] + Vec2d{static_cast<double>(dx), static_cast<double>(dy)});
        if (!finite(t)) continue;
        mean += t;
        ++count;
      }
    }
    Vec2d const t = truth(ours.position_px[i]);
    if (count == 0 || !finite(t)) continue;
    product += Vec2d{mean.x * t.x, mean.y * t.y} / static_cast<double>(count);
    square += Vec2d{t.x * t.x, t.y * t.y};
  }
  auto const share = [](double p, double s) { return s > 0.0 ? std::clamp(p / s, 0.0, 1.0) : 0.0; };
  return {share(product.x, square.x), share(product.y, square.y)};
}

/// Common input of the searches for mistakes.
struct Search {
  DisplacementField const& few;  ///< sample of the file's vectors
  Truth const& truth;
  int image_rows;
  double most;  ///< upper limit of a difference, see fit_within()
  ConventionFit own;

  ConventionFit fit(DisplacementField const& field) const {
    return fit_within(field, own.conventions, truth, image_rows, most);
  }
  /// Returns true if a correction reduces the rms by 30 % and the improvement is significant at five standard
  /// deviations.
  bool is_mended(ConventionFit const& other) const {
    return other.rms_px < 0.7 * own.rms_px && other.rms_px < 0.7 * other.signal_px && evidence_for(other, own) > 25.0;
  }
};

/// Searches for displacements that are a multiple of the true ones.
LikelyMistake find_factor(Search const& search) {
  DisplacementField const ours = apply_conventions(search.few, search.own.conventions, search.image_rows);
  Vec2d const share = share_in_windows(sample(ours, 500), search.truth);
  constexpr double least_followed = 0.05;  // minimum slope of windows that still measure a displacement
  Vec2d factor{1.0, 1.0};
  for (auto const component : {&Vec2d::x, &Vec2d::y}) {
    if (!(component_signal(ours, search.truth, component) > std::max(telling_signal_px, 0.2 * search.own.signal_px)))
      continue;  // this component is too small to determine a factor
    double const found = median_factor(ours, search.truth, component);
    if (found > 0.0 && (found > 1.1 || found < std::max(least_followed, 0.9 * (share.*component))))
      factor.*component = found;
  }
  if (factor == Vec2d{1.0, 1.0}) return {};
  // Use one factor for both components if the two agree.
  bool const both = std::abs(factor.x - factor.y) < 0.1 * std::max(factor.x, factor.y);
  if (both) factor.x = factor.y = 0.5 * (factor.x + factor.y);
  // Apply the factors to the columns of the file, which may be exchanged.
  Vec2d const of_columns = search.own.conventions.exchanges_components() ? Vec2d{factor.y, factor.x} : factor;
  ConventionFit const mended = search.fit(changed(search.few, of_columns, {}));
  if (!search.is_mended(mended)) return {};
  std::string const text =
      both ? fmt::format("displacements are {:.3g} times the truth, as in another unit than px", factor.x)
           : fmt::format("u is {:.3g} times and v {:.3g} times the truth", factor.x, factor.y);
  VectorConventions scaled = search.own.conventions;
  scaled.px_per_frame = std::stod(fmt::format("{:.3g}", scaled.px_per_frame.value_or(1.0) * factor.x));
  return {text, both ? describe(scaled) : std::string(), mended.rms_px, search.own.rms_px};
}

/// Searches for positions with another origin: the shift that fits best, on a lattice of 4 px up to 64 px, refined to a
/// quarter of a pixel.
LikelyMistake find_shift(Search const& search) {
  constexpr double farthest = 64.0;
  DisplacementField const fewer = sample(search.few, 400);
  auto const fit = [&](Vec2d shift) { return search.fit(changed(fewer, {1.0, 1.0}, shift)).rms_px; };
  Vec2d best{};
  double least = fit(best);
  auto const look_around = [&](Vec2d middle, double reach, double step) {
    for (double dy = -reach; dy <= reach; dy += step) {
      for (double dx = -reach; dx <= reach; dx += step) {
        double const rms = fit(middle + Vec2d{dx, dy});
        if (!(rms < least)) continue;
        least = rms;
        best = middle + Vec2d{dx, dy};
      }
    }
  };
  look_around({}, farthest, 4.0);
  for (double const step : {2.0, 1.0, 0.5, 0.25}) look_around(best, step, step);
  constexpr double counting = 2.0;  // conventions of pixel counting differ by less
  if (!(std::max(std::abs(best.x), std::abs(best.y)) > counting)) return {};
  ConventionFit const mended = search.fit(changed(search.few, {1.0, 1.0}, best));
  if (!search.is_mended(mended)) return {};
  return {fmt::format("places are shifted by ({:.4g}, {:.4g}) px", 0.0 - best.x, 0.0 - best.y),
          {},
          mended.rms_px,
          search.own.rms_px};
}

/// Searches for positions that are a multiple of the true ones.
LikelyMistake find_place_factor(Search const& search) {
  auto const scaled = [](DisplacementField field, double factor) {
    for (Vec2d& p : field.position_px) p = p / factor;
    return field;
  };
  DisplacementField const fewer = sample(search.few, 400);
  double best = 1.0, least = std::numeric_limits<double>::infinity();
  auto const look_around = [&](double middle, double reach, double step) {
    for (double e = -reach; e <= reach; e += step) {
      double const factor = middle * std::exp(e), rms = search.fit(scaled(fewer, factor)).rms_px;
      if (!(rms < least)) continue;
      least = rms;
      best = factor;
    }
  };
  look_around(1.0, 1.4, 0.01);  // from a quarter to four times
  look_around(best, 0.01, 0.001);
  if (std::abs(best - 1.0) < 0.01) return {};
  ConventionFit const mended = search.fit(scaled(search.few, best));
  if (!search.is_mended(mended)) return {};
  VectorConventions words = search.own.conventions;
  words.px = std::stod(fmt::format("{:.3g}", words.px.value_or(1.0) * best));
  return {fmt::format("places are {:.3g} times the true ones, as in another unit than px", best), describe(words),
          mended.rms_px, search.own.rms_px};
}

/// Searches for a factor or shift with the conventions in use. If `any_reading`, also searches for a factor with all
/// other conventions.
LikelyMistake find_scale_or_shift(Search search, std::vector<ConventionFit> const& fits,
                                  std::vector<VectorConventions> const& own, bool any_reading) {
  if (LikelyMistake found = find_factor(search); found.found()) return found;
  // A shift of a few pixels changes a smooth field by more than this fraction of the signal.
  if (search.own.rms_px > 0.03 * search.own.signal_px) {
    if (LikelyMistake found = find_shift(search); found.found()) return found;
    if (LikelyMistake found = find_place_factor(search); found.found()) return found;
  }
  if (!any_reading) return {};
  LikelyMistake best;
  double const as_read = search.own.rms_px;
  VectorConventions const first = search.own.conventions;
  double least_unlikely = std::numeric_limits<double>::infinity();
  for (ConventionFit const& fit : fits) {
    if (fit.conventions.offset_px != first.offset_px) continue;
    search.own = fit;
    LikelyMistake found = find_factor(search);
    double const unlikely = unlikelihood(fit.conventions, own);
    if (!found.found() || !(unlikely < least_unlikely)) continue;
    least_unlikely = unlikely;
    best = {difference_of(fit.conventions, first) + " and " + found.text, found.conventions, found.rms_px, as_read};
  }
  return best;
}

/// Returns a probable cause if no conventions fit.
std::string likely_cause(ConventionFit const& best) {
  if (std::abs(best.slope) < 0.1)
    return "places from another origin, or places or displacements that are not in px, look like this";
  return "places from another origin look like this";
}

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
      likely_cause(best));
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

}  // namespace

double unlikelihood(VectorConventions const& reading, VectorConventions const& own) {
  bool const y = reading.y_up != own.y_up, v = reading.v_up != own.v_up;
  return (y && v ? 1.1 : (y ? 1.0 : 0.0) + (v ? 1.0 : 0.0)) + (reading.swapped != own.swapped ? 1.0 : 0.0) +
         (reading.exchange != own.exchange ? 1.2 : 0.0) + (reading.offset_px != own.offset_px ? 0.3 : 0.0) +
         (reading.y_up && own.y_up && reading.mirror != own.mirror ? 0.2 : 0.0);
}

double evidence_for(ConventionFit const& a, ConventionFit const& b) {
  constexpr double alike_px = 1e-4;
  double const independent = 0.25 * static_cast<double>(std::min(a.components, b.components));
  return independent * 2.0 * std::log(std::max(b.rms_px, alike_px) / std::max(a.rms_px, alike_px));
}

ConventionFit fit_conventions(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                              int image_rows) {
  DisplacementField const few = sample(field, 4000);
  return fit_within(few, conventions, truth, image_rows, largest_difference(few, conventions, truth, image_rows));
}

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
      text, rms_px, rms_as_read, remedy);
}

DetectedConventions detect_conventions(VectorFile const& file, Truth const& truth, int image_rows) {
  DisplacementField const few = sample(file.field, 4000);
  std::vector<VectorConventions> own = file.also;
  own.insert(own.begin(), file.conventions);
  double const most = largest_difference(few, own.front(), truth, image_rows);
  std::vector<ConventionFit> fits;
  for (VectorConventions const& choice : every_choice(own))
    fits.push_back(fit_within(few, choice, truth, image_rows, most));

  // Use the first of the format's own conventions unless another fits better. For an offset alone, significance
  // suffices: software with image deformation measures at the nodes of its grid, but with a single pass half a pixel
  // away.
  DetectedConventions result;
  ConventionFit chosen = fits.front();
  for (std::size_t i = 1; i < own.size(); ++i) {
    bool const clear = same_axes(fits[i].conventions, chosen.conventions) || fits[i].rms_px < 0.9 * chosen.rms_px;
    if (clear && surely_better(fits[i], chosen)) chosen = fits[i];
  }
  result.verdict = judge(*std::min_element(fits.begin(), fits.end(), better));
  result.tried = best_of_axes(fits);
  result.best = likeliest(fits, own);
  if (result.verdict == Verdict::cannot_be_told) chosen = fits.front();

  // A better fit that is not the format's own is a mistake if the improvement is clear and, given the number of
  // candidates, significant at four standard deviations.
  bool const reads = result.verdict == Verdict::fits || result.verdict == Verdict::noisy;
  double const clearly = same_axes(result.best.conventions, chosen.conventions) ? 0.95 : 0.9;
  bool const is_own = std::find(own.begin(), own.end(), result.best.conventions) != own.end();
  if (reads && !is_own && result.best.rms_px < clearly * chosen.rms_px && evidence_for(result.best, chosen) > 16.0) {
    result.mistake = {difference_of(result.best.conventions, chosen.conventions), describe(result.best.conventions),
                      result.best.rms_px, chosen.rms_px};
    for (ConventionFit const& other : result.tried) {  // other mistakes that are indistinguishable in this displacement
      if (same_axes(other.conventions, result.best.conventions) || !fits_as_well(other, result.best)) continue;
      if (unlikelihood(other.conventions, own) > unlikelihood(result.best.conventions, own) + 0.5) continue;
      result.mistake.text += ", or " + difference_of(other.conventions, chosen.conventions);
    }
  }
  if (result.verdict != Verdict::cannot_be_told) {
    LikelyMistake other =
        find_scale_or_shift({few, truth, image_rows, most, chosen}, fits, own, result.verdict == Verdict::fits_none);
    if (other.found() && (!result.mistake.found() || other.rms_px < 0.9 * result.mistake.rms_px))
      result.mistake = std::move(other);
  }
  if (result.mistake.found()) result.verdict = Verdict::mistaken;

  auto const rival = std::find_if(result.tried.begin(), result.tried.end(), [&](ConventionFit const& other) {
    return !same_axes(other.conventions, chosen.conventions);
  });
  result.ambiguous =
      rival != result.tried.end() && !(chosen.rms_px < 0.9 * rival->rms_px) && result.verdict != Verdict::mistaken;
  result.conventions = chosen.conventions;
  result.fit = chosen;
  VectorConventions without = chosen.conventions;
  without.offset_px = 0.0;
  result.without_offset = fit_within(few, without, truth, image_rows, most);
  result.report = result.verdict == Verdict::fits_none ? misfit_report(file, result) : found_report(file, result);
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
