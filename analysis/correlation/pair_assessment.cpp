#include "analysis/correlation/pair_assessment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/outside_windows.h"
#include "analysis/correlation/pattern_period.h"
#include "analysis/correlation/standard_correlator.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline correlation {
namespace {

/// Minimum fraction of the windows with a signal that must pass the decorrelation test.
constexpr double least_correlated = 0.25;
/// Threshold of the decorrelation test in standard deviations: exceeded with a probability of 1 in 44 for a normal
/// distribution.
constexpr double deviations = 2.0;
/// Minimum fractions of the vectors: of doubtful vectors for the costly tests to be run, of ambiguous or uncorrelated
/// vectors for a warning, and of vectors with failed tests for a warning.
constexpr double suspicious = 0.05;
constexpr double worth_a_warning = 0.1;
constexpr double too_many_failed = 0.2;

/// Smallest number of windows for a median test: one and the neighbours by which it is tested.
constexpr std::size_t fewest_windows = fewest_neighbours + 1;

using Kind = PairVerdict::Kind;

bool has_signal(VectorReason reason) {
  return reason != VectorReason::masked && reason != VectorReason::outside && reason != VectorReason::no_signal;
}

bool is_of_a_test(VectorReason reason) {
  return reason == VectorReason::other_peak || reason == VectorReason::neighbours ||
         reason == VectorReason::not_replaced;
}

/// Counts of the vectors with a signal, by status and reason.
struct Tally {
  explicit Tally(DisplacementField const& field) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      known += field.reason[i] == VectorReason::no_signal;
      if (!has_signal(field.reason[i])) continue;
      ++signal;
      ++known;
      compared += std::isfinite(field.correlation[i]);
      uncorrelated += field.reason[i] == VectorReason::uncorrelated;
      beyond += field.reason[i] == VectorReason::beyond_limit;
      failed += is_of_a_test(field.reason[i]);
      not_replaced += field.reason[i] == VectorReason::not_replaced;
      ambiguous += field.ambiguous[i] != Ambiguity::none;
      doubtful += field.ambiguous[i] != Ambiguity::none || field.reason[i] != VectorReason::measured;
    }
  }
  bool nothing_left() const { return uncorrelated + beyond == signal; }
  double part(std::size_t count) const {
    return signal > 0 ? static_cast<double>(count) / static_cast<double>(signal) : 0.0;
  }
  std::size_t known = 0;     ///< number of vectors that are neither masked nor outside the frames
  std::size_t compared = 0;  ///< number of vectors with a correlation coefficient
  std::size_t signal = 0, uncorrelated = 0, beyond = 0, failed = 0, not_replaced = 0, ambiguous = 0, doubtful = 0;
};

/// Returns whether the mean length of the measured displacements is at most 0.01 px, as for identical frames. The
/// tolerance is required by method "mqd", whose planes decrease asymmetrically with the shift; other methods measure
/// zero apart from rounding.
bool stands_still(DisplacementField const& field) {
  double sum = 0.0, count = 0.0;
  for (Vec2d const& raw : field.raw_px) {
    if (std::isnan(raw.x)) continue;
    sum += length(raw);
    count += 1.0;
  }
  return count > 0.0 && sum <= 1e-2 * count;
}

/// Mean correlation and the number of independent windows over which it is averaged.
struct Mean {
  double value = 0.0;
  double windows = 0.0;
};

/// Returns the mean correlation of the vectors that are at most `reach` columns and rows away from a vector.
/// @param windows_per_vector  number of independent windows per vector: squared ratio of spacing to window size
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

/// Description of the search range for messages.
struct Reach {
  explicit Reach(CorrelationSettings const& settings) {
    int const range = CorrelationSchedule(settings).search_radius_px(0);
    bool const limited = settings.max_displacement_px && *settings.max_displacement_px <= range;
    what = limited ? fmt::format("correlate.max_displacement_px = {:g}", *settings.max_displacement_px)
                   : fmt::format("the search range of {} px", range);
    remedy = limited ? "increase it" : "use a larger first window in correlate.window_px";
  }
  std::string what;
  std::string remedy;  ///< change of the settings that enlarges the search range
};

std::string uncorrelated_text(Tally const& tally, Reach const& reach) {
  std::string const why = fmt::format(
      "they correlate no better than unrelated frames: a displacement beyond {}, two different scenes, or only noise",
      reach.what);
  if (tally.nothing_left())
    return fmt::format("the frames do not correlate ({}); {}, or use frames of one scene", why, reach.remedy);
  return fmt::format(
      "{:.0f} % of the windows do not correlate ({}), so that their vectors are invalid; use larger windows, or "
      "exclude these vectors",
      100.0 * tally.part(tally.uncorrelated), why);
}

std::string beyond_text(Tally const& tally, Reach const& reach, CorrelationSettings const& settings) {
  if (correlation_method(settings.method).optical_flow)
    return fmt::format(
        "{:.0f} % of the vectors are longer than correlate.max_displacement_px = {:g}, and are invalid; increase it, "
        "or exclude these vectors",
        100.0 * tally.part(tally.beyond), settings.max_displacement_px.value_or(0.0));
  return fmt::format(
      "{:.0f} % of the windows have no correlation peak within {} (the displacements are larger, or these windows "
      "contain only noise), so that their vectors are invalid; {}, or exclude these vectors",
      100.0 * tally.part(tally.beyond), reach.what, reach.remedy);
}

std::string failed_text(DisplacementField const& field, Tally const& tally) {
  struct Test {
    FailedTest test;
    char const* name;
  };
  constexpr std::array tests{Test{FailedTest::median, "median"}, Test{FailedTest::displacement, "whole displacement"},
                             Test{FailedTest::peak_ratio, "peak ratio"}, Test{FailedTest::correlation, "correlation"}};
  std::vector<std::string> by_test;
  for (auto const& [test, name] : tests) {
    auto const count = static_cast<std::size_t>(std::count(field.failed.begin(), field.failed.end(), test));
    if (count > 0) by_test.push_back(fmt::format("{} {:.0f} %", name, 100.0 * tally.part(count)));
  }
  std::size_t const replaced = tally.failed - tally.not_replaced;
  std::vector<std::string> became;
  if (replaced > 0)
    became.push_back(
        fmt::format("{:.0f} % are replaced, by another peak or by their neighbours", 100.0 * tally.part(replaced)));
  if (tally.not_replaced > 0)
    became.push_back(fmt::format("{:.0f} % are invalid", 100.0 * tally.part(tally.not_replaced)));
  return fmt::format("{:.0f} % of the vectors failed a test ({}): {}; inspect the frames, use larger windows, or {}",
                     100.0 * tally.part(tally.failed), fmt::join(by_test, ", "), fmt::join(became, ", "),
                     replaced > 0 ? "set correlate.replace = false to exclude these vectors" : "relax the test");
}

}  // namespace

void reject_uncorrelated_vectors(DisplacementField& field, DisplacementField const& chance,
                                 CorrelationSettings const& settings) {
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
    if (field.reason[i] == VectorReason::beyond_limit) continue;
    field.displacement_px[i] = {not_a_number, not_a_number};
    field.status[i] = VectorStatus::invalid;
    field.reason[i] = VectorReason::uncorrelated;
    if (!field.failed.empty()) field.failed[i] = FailedTest::none;
  }
}

namespace {

/// Returns the verdict on a pair that cannot be assessed by its vectors; nullopt if it can be assessed.
std::optional<PairVerdict> find_reason_not_to_judge(Tally const& found, CorrelationSettings const& settings) {
  if (found.signal == 0) return PairVerdict{found.known == 0 ? Kind::masked : Kind::no_signal};
  if (correlation_method(settings.method).optical_flow) return PairVerdict{Kind::optical_flow};
  if (found.part(found.doubtful) >= suspicious) return std::nullopt;
  if (found.signal < fewest_windows) return PairVerdict{Kind::few_windows, static_cast<double>(fewest_windows)};
  if (!settings.median_threshold) return PairVerdict{Kind::no_median_test};
  return std::nullopt;
}

/// Results of the costly tests, which are run only if the vectors alone are not conclusive.
struct Evidence {
  std::function<bool()> same_pictures;
  std::function<std::optional<PatternPeriod>()> period;
  std::function<DisplacementField()> chance;
};

/// Returns the verdict on the pair from the vectors that passed the decorrelation test. @pre the pair can be assessed
/// by its vectors
PairVerdict judge_vectors(DisplacementField const& field, Tally const& left) {
  if (std::any_of(field.status.begin(), field.status.end(), is_valid_or_replaced)) return {Kind::correlates};
  return {left.nothing_left() ? Kind::uncorrelated : Kind::no_valid_vector};
}

void judge(DisplacementField& field, Evidence const& evidence, CorrelationSettings const& settings) {
  if (stands_still(field) && evidence.same_pictures()) {
    field.warnings.push_back(
        {WarningCode::unreliable, "",
         "both frames are the same image, bit for bit (so that every displacement is 0); use two different frames"});
    field.verdict = {Kind::identical_frames};
    return;
  }
  Tally const found(field);
  std::optional<PairVerdict> const not_judged = find_reason_not_to_judge(found, settings);
  field.verdict = not_judged ? *not_judged : judge_vectors(field, found);
  if (found.part(found.doubtful) < suspicious) return;
  Reach const reach(settings);
  std::optional<PatternPeriod> const period = evidence.period();
  if (period) {
    if (found.part(found.ambiguous) >= worth_a_warning)
      field.warnings.push_back(
          {WarningCode::unreliable, "",
           fmt::format("the pattern repeats every {:.2f} px (with an autocorrelation of {:.2f}), within {}: only "
                       "displacements below {:.2f} px are unambiguous, larger ones are reduced by whole periods; use "
                       "random dots, or set correlate.max_displacement_px below {:.2f} if no displacement is larger",
                       period->pitch_px, period->height, reach.what, 0.5 * period->pitch_px, 0.5 * period->pitch_px)});
    field.verdict = {Kind::periodic, period->pitch_px};
  } else if (found.compared > 0) {
    // Clear the ambiguities of earlier passes: a large window across a gradient has several peaks, but the smaller
    // windows of later passes have resolved this ambiguity.
    std::replace(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::earlier, Ambiguity::none);
    reject_uncorrelated_vectors(field, evidence.chance(), settings);
  }
  Tally const left(field);
  if (!period && !not_judged) field.verdict = judge_vectors(field, left);
  bool const differ = left.part(left.uncorrelated) >= worth_a_warning;
  if (differ) field.warnings.push_back({WarningCode::unreliable, "", uncorrelated_text(left, reach)});
  if (left.part(left.beyond) >= worth_a_warning && !(differ && left.nothing_left()))
    field.warnings.push_back({WarningCode::unreliable, "", beyond_text(left, reach, settings)});
  if (left.part(left.failed) >= too_many_failed)
    field.warnings.push_back({WarningCode::unreliable, "", failed_text(field, left)});
}

/// Returns a composite of the sequence: every pixel is taken from the first pair in which both frames have a value
/// there.
HostFrames known_in_any(PairSequence const& pairs) {
  HostFrames const first = pairs.frames(0);
  Image<double> reference = first.reference(), flow = first.flow();
  for (std::size_t k = 1; k < pairs.size; ++k) {
    HostFrames const frames = pairs.frames(k);
    for (std::size_t i = 0; i < reference.size(); ++i) {
      if (std::isfinite(reference.data()[i]) && std::isfinite(flow.data()[i])) continue;
      reference.data()[i] = frames.reference().data()[i];
      flow.data()[i] = frames.flow().data()[i];
    }
  }
  return {std::move(reference), std::move(flow)};
}

}  // namespace

bool frames_correlate(DisplacementField const& field) { return field.verdict.kind != Kind::uncorrelated; }

bool are_identical_frames(Image<double> const& a, Image<double> const& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  });
}

void assess_pair(DisplacementField& field, StoredFrames const& frames, Correlator const& correlator,
                 CorrelationSettings const& settings) {
  if (field.verdict != PairVerdict{}) return;
  mark_windows_outside(field, frames, settings);
  judge(field,
        {[&] { return are_identical_frames(frames.reference(), frames.flow()); },
         [&] { return pattern_period(frames.reference(), settings); },
         [&] { return correlator.correlate(frames.reference(), upside_down(frames.flow())); }},
        settings);
}

void assess_ensemble(DisplacementField& field, PairSequence const& pairs, CorrelationSettings const& settings) {
  auto const is_masked = [](VectorReason reason) { return reason == VectorReason::masked; };
  if (std::any_of(field.reason.begin(), field.reason.end(), is_masked))
    mark_windows_outside(field, known_in_any(pairs), settings);
  auto const all_same = [&] {
    for (std::size_t k = 0; k < pairs.size; ++k) {
      HostFrames const frames = pairs.frames(k);
      if (!are_identical_frames(frames.reference(), frames.flow())) return false;
    }
    return true;
  };
  auto const any_period = [&] {
    std::optional<PatternPeriod> period;
    for (std::size_t k = 0; k < pairs.size && !period; ++k)
      period = pattern_period(pairs.frames(k).reference(), settings);
    return period;
  };
  auto const turned = [&](std::size_t k) {
    HostFrames const frames = pairs.frames(k);
    return HostFrames(frames.reference(), upside_down(frames.flow()));
  };
  auto const chance = [&] { return correlate_ensemble({pairs.size, turned}, settings); };
  judge(field, {all_same, any_period, chance}, settings);
}

}  // namespace gladstone::inline correlation
