#include "analysis/pair_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "analysis/pattern_period.h"
#include "analysis/standard_correlator.h"

namespace gladstone {
namespace {

/// Part of the windows with a signal that must be more than chance.
constexpr double least_correlated = 0.25;
/// Standard deviations by which correlation must be above chance: one in 44 is, were it normally distributed.
constexpr double deviations = 2.0;
/// Part of a measurement from which it is looked into, and from which it is spoken of.
constexpr double suspicious = 0.05;
constexpr double worth_a_warning = 0.1;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool has_signal(VectorReason reason) { return reason != VectorReason::masked && reason != VectorReason::no_signal; }

/// Vectors with a signal, and parts of them.
struct Tally {
  explicit Tally(DisplacementField const& field) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (!has_signal(field.reason[i])) continue;
      ++signal;
      uncorrelated += field.reason[i] == VectorReason::uncorrelated;
      ambiguous += field.ambiguous[i] != Ambiguity::none;
      doubtful += field.ambiguous[i] != Ambiguity::none || field.reason[i] != VectorReason::measured;
    }
  }
  double part(std::size_t count) const {
    return signal > 0 ? static_cast<double>(count) / static_cast<double>(signal) : 0.0;
  }
  std::size_t signal = 0, uncorrelated = 0, ambiguous = 0, doubtful = 0;
};

bool same_bits(Image<double> const& a, Image<double> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

/// Whether every window's best peak is at no shift, up to what float leaves of it.
bool stands_still(DisplacementField const& field) {
  return std::none_of(field.raw_px.begin(), field.raw_px.end(), [](Vec2d d) { return length(d) > 1e-2; });
}

/// A mean, and how many independent windows it is of.
struct Mean {
  double value = 0.0;
  double windows = 0.0;
};

/// Mean correlation of the vectors up to `reach` columns and rows away from one.
/// @param windows_per_vector that share no pixel: spacing squared over window squared
Mean local_mean(DisplacementField const& field, std::size_t vector, int reach, double windows_per_vector) {
  int const column = static_cast<int>(vector) % field.columns, row = static_cast<int>(vector) / field.columns;
  double sum = 0.0, count = 0.0;
  for (int y = std::max(0, row - reach); y <= std::min(field.rows - 1, row + reach); ++y)
    for (int x = std::max(0, column - reach); x <= std::min(field.columns - 1, column + reach); ++x) {
      double const value = field.correlation[static_cast<std::size_t>(y) * field.columns + x];
      if (std::isnan(value)) continue;
      sum += value;
      count += 1.0;
    }
  return {sum / count, std::max(1.0, count * windows_per_vector)};
}

Image<double> upside_down(Image<double> image) {
  std::reverse(image.begin(), image.end());
  return image;
}

std::string uncorrelated_text(Tally const& tally, int range) {
  std::string const why = fmt::format(
      "they agree no better than frames that have nothing in common: a shift beyond the search range of {} px, two "
      "scenes, or noise alone",
      range);
  if (tally.uncorrelated == tally.signal)
    return fmt::format(
        "the frames do not correlate ({}); use a larger first window in correlate.window_px, or frames "
        "that belong together",
        why);
  return fmt::format(
      "{:.0f} % of the windows do not correlate ({}), so that their vectors are invalid; use larger "
      "windows, or leave these vectors out",
      100.0 * tally.part(tally.uncorrelated), why);
}

}  // namespace

void leave_out_chance(DisplacementField& field, DisplacementField const& chance, CorrelationSettings const& settings) {
  InterrogationGrid const grid = final_grid(settings, settings.window_px.back(), settings.window_px.back());
  double const share = static_cast<double>(grid.spacing_px) / grid.window_px, windows_per_vector = share * share;
  int const reach = 2 * grid.window_px / grid.spacing_px;
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (double const value : chance.correlation) {
    if (std::isnan(value)) continue;
    sum += value;
    squares += value * value;
    count += 1.0;
  }
  double const mean = count > 0.0 ? sum / count : 0.0;
  double const variance = count > 0.0 ? std::max(0.0, squares / count - mean * mean) : 0.0;
  double const all_windows = std::max(1.0, count * windows_per_vector);
  std::vector<std::size_t> uncorrelated, signal;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!has_signal(field.reason[i])) continue;
    signal.push_back(i);
    Mean const here = local_mean(field, i, reach, windows_per_vector);
    double const deviation = std::sqrt(variance * (1.0 / here.windows + 1.0 / all_windows));
    if (!(here.value > mean + deviations * deviation)) uncorrelated.push_back(i);
  }
  double const correlated = static_cast<double>(signal.size() - uncorrelated.size());
  bool const hardly_any = correlated < least_correlated * static_cast<double>(signal.size());
  for (std::size_t const i : hardly_any ? signal : uncorrelated) {
    field.displacement_px[i] = {nan, nan};
    field.status[i] = VectorStatus::invalid;
    field.reason[i] = VectorReason::uncorrelated;
  }
}

void judge_pair(DisplacementField& field, FramePair const& frames, Correlator const& correlator,
                CorrelationSettings const& settings) {
  int const range = CorrelationSchedule(settings).search_radius_px(0);
  if (stands_still(field) && same_bits(frames.reference(), frames.flow())) {
    field.warnings.emplace_back(
        "both frames are the same picture, bit for bit (so that every displacement is 0); give two frames");
    return;
  }
  Tally const found(field);
  if (found.part(found.doubtful) < suspicious) return;
  std::optional<PatternPeriod> const period = pattern_period(frames.reference(), settings);
  if (period) {
    if (found.part(found.ambiguous) >= worth_a_warning)
      field.warnings.push_back(fmt::format(
          "the pattern repeats every {:.2f} px (its autocorrelation is {:.2f} there), within the search range of {} "
          "px: only a displacement below {:.2f} px can be trusted, a larger one comes back less by whole pitches; use "
          "random dots, or set correlate.max_displacement_px below {:.2f} if no displacement is larger",
          period->pitch_px, period->height, range, 0.5 * period->pitch_px, 0.5 * period->pitch_px));
    return;
  }
  // large windows that straddle a gradient have several peaks, among which the smaller ones have decided
  std::replace(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::earlier, Ambiguity::none);
  leave_out_chance(field, correlator.correlate(frames.reference(), upside_down(frames.flow())), settings);
  Tally const left(field);
  if (left.part(left.uncorrelated) >= worth_a_warning) field.warnings.push_back(uncorrelated_text(left, range));
}

}  // namespace gladstone
