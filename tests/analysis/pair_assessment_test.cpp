#include "analysis/correlation/pair_assessment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "analysis/correlation/correlation_methods.h"
#include "render/base/units.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/support/contains_whole.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

using Kind = PairVerdict::Kind;

auto everywhere(double u, double v) {
  return [u, v](Vec2d) { return Vec2d{u, v}; };
}

/// Vectors and verdict as reported to the user.
DisplacementField judged(ParticlePair const& pair, CorrelationSettings const& settings = {}) {
  auto const correlator = make_correlator(settings);
  HostFrames const frames(pair.reference, pair.flow);
  DisplacementField field = correlator->correlate_pair(frames);
  assess_pair(field, frames, *correlator, settings);
  return field;
}

CorrelationSettings within(double limit_px) {
  CorrelationSettings settings;
  settings.max_displacement_px = limit_px;
  return settings;
}

CorrelationSettings windows_of(int pixels) {
  CorrelationSettings settings;
  settings.window_px = {pixels};
  return settings;
}

std::size_t count(DisplacementField const& field, VectorReason reason) {
  return static_cast<std::size_t>(std::count(field.reason.begin(), field.reason.end(), reason));
}

std::size_t counting(DisplacementField const& field) {
  std::size_t number = 0;
  for (std::size_t i = 0; i < field.size(); ++i) number += field.counts(i);
  return number;
}

ParticlePair two_scenes(ParticleSettings settings) {
  ParticlePair pair = render_particle_pair(settings, everywhere(0.0, 0.0));
  settings.seed += 100;
  pair.flow = render_particle_pair(settings, everywhere(0.0, 0.0)).flow;
  return pair;
}

ParticlePair noise_alone(int pixels) {
  ParticlePair pair{{Image<double>(pixels, pixels, 0.0), Image<double>(pixels, pixels, 0.0)}};
  std::mt19937 bits(5);
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (double& value : *image) value = static_cast<double>(bits() % 256);
  return pair;
}

// The search radius of the first pass is 32 px.
TEST(PairVerdict, DetectsUncorrelatedFrames) {
  std::vector<ParticlePair> const pairs{
      render_particle_pair({.columns = 200, .rows = 200}, everywhere(40.0, 0.0)),
      render_particle_pair({.columns = 200, .rows = 200, .noise = 0.05, .seed = 3}, everywhere(0.0, -40.0)),
      render_particle_pair({.columns = 200, .rows = 200, .seed = 4}, everywhere(36.0, 36.0)),
      two_scenes({.columns = 200, .rows = 200}),
      two_scenes({.columns = 80, .rows = 80}),
      two_scenes({.columns = 200, .rows = 200, .particles_per_px = 5.0 / 1024.0}),
      noise_alone(200)};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    DisplacementField const field = judged(pairs[k]);
    EXPECT_EQ(counting(field), 0u) << k;
    EXPECT_FALSE(frames_correlate(field)) << k;
    EXPECT_GT(count(field, VectorReason::uncorrelated), field.size() / 2) << k;
    EXPECT_THAT(field.warnings, ElementsAre(Warns("unreliable"))) << k;
    for (std::size_t i = 0; i < field.size(); ++i) EXPECT_TRUE(std::isnan(field.displacement_px[i].x));
  }
}

TEST(PairVerdict, DoesNotWarnOfCorrelatedFrames) {
  auto const sine = [](Vec2d p) { return Vec2d{std::sin(2.0 * pi * p.y / 64.0), std::sin(2.0 * pi * p.x / 64.0)}; };
  std::vector<ParticlePair> const pairs{
      render_particle_pair({.columns = 200, .rows = 200}, everywhere(0.3, -0.2)),
      render_particle_pair({.columns = 200, .rows = 200, .noise = 0.05}, everywhere(0.02, 0.0)),
      render_particle_pair({.columns = 200, .rows = 200, .noise = 0.05}, everywhere(0.0, 0.0)),
      render_particle_pair({.columns = 200, .rows = 200}, everywhere(20.0, 3.0)),
      render_particle_pair({.columns = 64, .rows = 64, .noise = 0.05}, everywhere(1.3, -0.2)),
      render_particle_pair({.columns = 96, .rows = 96, .noise = 0.05}, everywhere(12.3, -0.2)),
      render_particle_pair({.columns = 200, .rows = 200, .noise = 0.05}, sine)};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    DisplacementField const field = judged(pairs[k]);
    EXPECT_THAT(field.warnings, IsEmpty()) << k;
    EXPECT_EQ(count(field, VectorReason::uncorrelated), 0u) << k;
    EXPECT_EQ(counting(field) + count(field, VectorReason::masked), field.size()) << k;
  }
}

// Few dots in strong noise: one vector in eleven is replaced, which triggers the test, but the remaining vectors agree
// better than chance.
TEST(PairVerdict, RetainsWeaklyCorrelatedVectors) {
  DisplacementField const field = judged(render_particle_pair(
      {.columns = 200, .rows = 200, .particles_per_px = 6.0 / 1024.0, .noise = 0.1}, everywhere(2.3, -0.2)));
  EXPECT_GT(count(field, VectorReason::neighbours) + count(field, VectorReason::other_peak), field.size() / 20);
  EXPECT_LT(count(field, VectorReason::uncorrelated), field.size() / 10);
  EXPECT_THAT(field.warnings, IsEmpty());
}

// The pair of the previous test with a stricter validation: if a fifth of the vectors is rejected, the pair counts as
// no measurement, whether they are replaced or invalid.
TEST(PairVerdict, WarnsIfOneFifthFailsValidation) {
  ParticlePair const pair = render_particle_pair(
      {.columns = 200, .rows = 200, .particles_per_px = 6.0 / 1024.0, .noise = 0.1}, everywhere(2.3, -0.2));
  CorrelationSettings settings;
  settings.least_peak_ratio = 2.0;
  DisplacementField const filled = judged(pair, settings);
  EXPECT_GT(count(filled, VectorReason::neighbours) + count(filled, VectorReason::other_peak), filled.size() / 5);
  EXPECT_THAT(filled.warnings,
              ElementsAre(Warns("unreliable", AllOf(HasSubstr("peak ratio"), HasSubstr("correlate.replace = false")))));
  settings.replace = false;
  DisplacementField const field = judged(pair, settings);
  EXPECT_EQ(std::count(field.status.begin(), field.status.end(), VectorStatus::replaced), 0);
  EXPECT_GT(count(field, VectorReason::not_replaced), field.size() / 5);
  for (std::size_t i = 0; i < field.size(); ++i) {
    EXPECT_EQ(std::isnan(field.displacement_px[i].x), !field.counts(i)) << i;
    EXPECT_EQ(field.failed[i] != FailedTest::none, field.reason[i] == VectorReason::not_replaced) << i;
  }
  EXPECT_THAT(field.warnings, ElementsAre(Warns("unreliable", Not(HasSubstr("correlate.replace")))));
}

PairSequence repeated(std::size_t pairs, ParticleSettings const& settings, double flow_px, std::uint64_t other_seed) {
  return {pairs, [=](std::size_t k) {
            ParticleSettings one = settings;
            one.seed += 2 * k;
            Image<double> reference = render_particle_pair(one, everywhere(flow_px, 0.0)).reference;
            one.seed += other_seed;
            return HostFrames(std::move(reference), render_particle_pair(one, everywhere(flow_px, 0.0)).flow);
          }};
}

// Six pairs with few dots in noise, as an ensemble; six whose frames are unrelated; six whose frames are identical.
TEST(EnsembleVerdict, IsThatOfAllPairs) {
  ParticleSettings const few{.columns = 200, .rows = 200, .particles_per_px = 4.0 / 1024.0, .noise = 0.1};
  CorrelationSettings const settings = windows_of(32);
  auto const verdict = [&](PairSequence const& pairs) {
    DisplacementField field = correlate_ensemble(pairs, settings);
    assess_ensemble(field, pairs, settings);
    return field;
  };
  DisplacementField const good = verdict(repeated(6, few, 2.3, 0));
  EXPECT_EQ(good.verdict.kind, Kind::correlates);
  EXPECT_THAT(good.warnings, IsEmpty());
  DisplacementField const strangers = verdict(repeated(6, few, 2.3, 1));
  EXPECT_EQ(strangers.verdict.kind, Kind::uncorrelated);
  EXPECT_EQ(counting(strangers), 0u);
  EXPECT_THAT(strangers.warnings, ElementsAre(Warns("unreliable")));
  PairSequence const moving = repeated(6, few, 2.3, 0);
  DisplacementField const still = verdict({6, [&](std::size_t k) {
                                             Image<double> const frame = moving.frames(k).reference();
                                             return HostFrames(frame, frame);
                                           }});
  EXPECT_EQ(still.verdict.kind, Kind::identical_frames);
  EXPECT_THAT(still.warnings, ElementsAre(Warns("unreliable")));
}

/// The first pairs of `first`, followed by those of `then`.
PairSequence one_after_another(PairSequence const& first, PairSequence const& then) {
  return {first.size + then.size,
          [=](std::size_t k) { return k < first.size ? first.frames(k) : then.frames(k - first.size); }};
}

// A pair that is masked or has no signal has the same effect in every position of the ensemble.
TEST(EnsembleVerdict, DoesNotDependOnTheOrderOfPairs) {
  CorrelationSettings const settings = windows_of(32);
  PairSequence const regular{2, [](std::size_t) {
                               Image<double> frame(200, 200);
                               for (int j = 0; j < 200; ++j)
                                 for (int i = 0; i < 200; ++i)
                                   frame(i, j) = std::cos(2.0 * pi * i / 8.0) + std::cos(2.0 * pi * j / 8.0);
                               Image<double> moved(200, 200);
                               for (int j = 0; j < 200; ++j)
                                 for (int i = 0; i < 200; ++i) moved(i, j) = frame((i + 197) % 200, j);
                               return HostFrames(std::move(frame), std::move(moved));
                             }};
  double const nan = std::numeric_limits<double>::quiet_NaN();
  PairSequence const masked{
      1, [nan](std::size_t) { return HostFrames(Image<double>(200, 200, nan), Image<double>(200, 200, nan)); }};
  for (PairSequence const& pairs : {one_after_another(regular, masked), one_after_another(masked, regular)}) {
    DisplacementField field = correlate_ensemble(pairs, settings);
    assess_ensemble(field, pairs, settings);
    EXPECT_EQ(field.verdict.kind, Kind::periodic);
    EXPECT_NEAR(field.verdict.number, 8.0, 0.05) << "the pitch, interpolated between pixels";
    EXPECT_EQ(count(field, VectorReason::masked), 0u);
    EXPECT_GT(std::count(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::here), 0);
  }
}

// Frames that correlate, with a test that no vector passes.
TEST(PairVerdict, ValidationFailuresAreNotDecorrelation) {
  CorrelationSettings settings;
  settings.least_peak_ratio = 1e9;
  DisplacementField const field =
      judged(render_particle_pair({.columns = 128, .rows = 128}, everywhere(0.3, -0.2)), settings);
  EXPECT_EQ(counting(field), 0u);
  EXPECT_EQ(field.verdict.kind, Kind::no_valid_vector);
  EXPECT_THAT(field.warnings, ElementsAre(Warns("unreliable", AllOf(HasSubstr("peak ratio"), ContainsWhole("100 %"),
                                                                    Not(HasSubstr("correlate.replace"))))));
}

// Left half 0.4 px, right half 45 px: windows farther from the middle than their search radius are either correct or
// invalid.
TEST(PairVerdict, RejectsUncorrelatedHalf) {
  std::size_t right_half = 0, left_out = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    ParticlePair pair = render_particle_pair({.seed = seed}, everywhere(0.4, 0.0));
    ParticlePair const other = render_particle_pair({.seed = seed + 1}, everywhere(45.0, 0.0));
    for (int j = 0; j < 256; ++j)
      for (int i = 128; i < 256; ++i) {
        pair.reference(i, j) = other.reference(i, j);
        pair.flow(i, j) = other.flow(i, j);
      }
    DisplacementField const field = judged(pair);
    EXPECT_THAT(field.warnings, ElementsAre(Warns("unreliable"))) << seed;
    EXPECT_GT(count(field, VectorReason::uncorrelated), 0u) << seed;
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (field.position_px[i].x < 128.0 - 32.0) {
        EXPECT_NEAR(field.displacement_px[i].x, 0.4, 0.3) << seed << ' ' << i;
      }
      if (field.position_px[i].x < 128.0 + 48.0) continue;
      ++right_half;
      left_out += !field.counts(i);
    }
  }
  // A mean over windows exceeds chance by two standard deviations once in 44 cases, but neighbours share most of their
  // windows, so that whole patches exceed it together: a fifth of the half in one pair, none in most. Hence eight
  // pairs.
  EXPECT_GT(left_out, right_half * 9 / 10);
}

TEST(PairVerdict, WarnsOfOnePictureGivenTwice) {
  ParticlePair pair = render_particle_pair({.columns = 128, .rows = 128, .noise = 0.05}, everywhere(0.3, 0.0));
  pair.flow = pair.reference;
  for (CorrelationMethod const& method : all_correlation_methods()) {
    if (method.tracks_dots) continue;  // see TrackingCorrelator
    CorrelationSettings settings;
    settings.method = method.name;
    DisplacementField const field = judged(pair, settings);
    EXPECT_THAT(field.warnings, ElementsAre(Warns("unreliable"))) << method.name;
    EXPECT_EQ(field.verdict.kind, Kind::identical_frames) << method.name;
  }
  pair.flow(60, 60) += 1.0;
  EXPECT_THAT(judged(pair).warnings, IsEmpty()) << "the images differ, as for a small real displacement";
}

TEST(PairVerdict, ReportsNoDisplacementWithoutSignal) {
  ParticlePair const flat{{Image<double>(128, 128, 100.0), Image<double>(128, 128, 100.0)}};
  EXPECT_THAT(judged(flat).warnings, IsEmpty());
}

// Every pair has a verdict.
TEST(PairVerdict, EveryPairHasAResult) {
  ParticleSettings const small{.columns = 128, .rows = 128, .noise = 0.05};
  ParticlePair twice = render_particle_pair(small, everywhere(0.3, 0.0));
  EXPECT_EQ(judged(twice).verdict.kind, Kind::correlates);
  EXPECT_EQ(judged(two_scenes({.columns = 200, .rows = 200})).verdict.kind, Kind::uncorrelated);
  EXPECT_EQ(judged(render_particle_pair({.columns = 200, .rows = 200}, everywhere(6.0, 0.0)), within(4.0)).verdict.kind,
            Kind::uncorrelated);
  EXPECT_EQ(judged(render_particle_pair({.columns = 200, .rows = 200, .particles_per_px = 6.0 / 1024.0, .noise = 0.1},
                                        everywhere(2.3, -0.2)))
                .verdict.kind,
            Kind::correlates);
  PairVerdict const periodic =
      judged(render_particle_pair({.noise = 0.05, .pitch_px = 8.3}, everywhere(2.5, 0.0))).verdict;
  EXPECT_EQ(periodic.kind, Kind::periodic);
  EXPECT_NEAR(periodic.number, 8.3, 0.05);
  ParticlePair const flat{{Image<double>(128, 128, 100.0), Image<double>(128, 128, 100.0)}};
  EXPECT_EQ(judged(flat).verdict.kind, Kind::no_signal);
  double const nan = std::numeric_limits<double>::quiet_NaN();
  ParticlePair const masked{{Image<double>(128, 128, nan), Image<double>(128, 128, nan)}};
  EXPECT_EQ(judged(masked).verdict.kind, Kind::masked);
  CorrelationSettings settings;
  settings.median_threshold.reset();
  EXPECT_EQ(judged(twice, settings).verdict.kind, Kind::no_median_test);
  settings = {};
  settings.method = "dis";
  EXPECT_EQ(judged(twice, settings).verdict.kind, Kind::optical_flow);
  settings.max_displacement_px = 0.1;
  EXPECT_THAT(judged(twice, settings).warnings,
              ElementsAre(Warns("unreliable", HasSubstr("correlate.max_displacement_px = 0.1"))));
  EXPECT_EQ(judged(render_particle_pair({.columns = 64, .rows = 64}, everywhere(0.3, 0.0)), windows_of(64)).verdict,
            (PairVerdict{Kind::few_windows, 4.0}));
  twice.flow = twice.reference;
  EXPECT_EQ(judged(twice).verdict.kind, Kind::identical_frames);
}

// The first pass finds random peaks at up to 32 px, which move windows at the edge out of the frames. Nothing is masked
// there.
TEST(OutsideWindows, AreNotCalledMasked) {
  ParticlePair pair = render_particle_pair({.columns = 256, .rows = 256, .noise = 0.02}, everywhere(0.0, 0.0));
  Image<double> const still = pair.reference;
  for (int j = 0; j < 256; ++j)
    for (int i = 0; i < 256; ++i) pair.flow(i, j) = still((i + 256 - 40) % 256, j);
  DisplacementField const rolled = judged(pair);
  EXPECT_EQ(count(rolled, VectorReason::masked), 0u);
  EXPECT_GT(count(rolled, VectorReason::outside), 0u);
  for (std::size_t i = 0; i < rolled.size(); ++i) {
    if (rolled.reason[i] != VectorReason::outside) continue;
    EXPECT_EQ(rolled.status[i], VectorStatus::invalid);
  }
}

// A displacement of 28 px to the right, and a mask 60 px wide in the middle of frame A only: windows on the mask are
// masked, those at the edge have left the frames.
TEST(OutsideWindows, AreDistinguishedFromMaskedOnes) {
  ParticlePair pair = render_particle_pair({.columns = 256, .rows = 256}, everywhere(28.0, 0.0));
  double const nan = std::numeric_limits<double>::quiet_NaN();
  for (int j = 0; j < 256; ++j)
    for (int i = 100; i < 160; ++i) pair.reference(i, j) = nan;
  DisplacementField const field = judged(pair);
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const x = field.position_px[i].x;
    if (field.reason[i] == VectorReason::masked) {
      EXPECT_TRUE(x > 80.0 && x < 200.0) << x;
    }
    if (field.reason[i] == VectorReason::outside) {
      EXPECT_TRUE(x < 28.0 || x > 227.0) << x;
    }
  }
  EXPECT_GT(count(field, VectorReason::masked), 100u);
  EXPECT_GT(count(field, VectorReason::outside), 10u);
}

// A displacement of 0.3 pitch; every alias within 32 px correlates equally well.
TEST(PairVerdict, WarnsOfAPatternThatRepeats) {
  ParticlePair const pair = render_particle_pair({.noise = 0.05, .pitch_px = 8.3}, everywhere(2.5, 0.0));
  DisplacementField const unbounded = judged(pair);
  EXPECT_THAT(unbounded.warnings,
              ElementsAre(Warns("unreliable", AllOf(HasSubstr("8.3"), HasSubstr("32 px"),
                                                    HasSubstr("max_displacement_px"), HasSubstr("4.1")))));
  EXPECT_EQ(counting(unbounded), unbounded.size()) << "the ambiguity is reported, and the vectors are kept";
  DisplacementField const bounded = judged(pair, within(4.1));
  EXPECT_THAT(bounded.warnings, IsEmpty()) << "no other displacement is within the limit";
  EXPECT_EQ(std::count(bounded.ambiguous.begin(), bounded.ambiguous.end(), Ambiguity::none),
            static_cast<std::ptrdiff_t>(bounded.size()));
}

// A displacement of 6 px with a limit of 4 px.
TEST(PairVerdict, ReportsLimitThatRejectsAllVectors) {
  DisplacementField const regular = judged(render_particle_pair({.pitch_px = 12.5}, everywhere(6.0, 0.0)), within(4.0));
  EXPECT_EQ(counting(regular), 0u);
  EXPECT_EQ(count(regular, VectorReason::beyond_limit), regular.size());
  EXPECT_THAT(
      regular.warnings,
      ElementsAre(Warns("unreliable", AllOf(HasSubstr("100 %"), HasSubstr("correlate.max_displacement_px = 4")))));
  DisplacementField const random = judged(render_particle_pair({}, everywhere(6.0, 0.0)), within(4.0));
  EXPECT_EQ(counting(random), 0u);
  ASSERT_FALSE(random.warnings.empty());
  EXPECT_THAT(random.warnings[0], Warns("unreliable", HasSubstr("max_displacement_px = 4")));
  EXPECT_FALSE(frames_correlate(random));
}

/// A grid of 10 x 10 disjoint windows of 32 px with the given correlation.
DisplacementField with_correlation(double mean, double scatter) {
  DisplacementField field;
  field.columns = field.rows = 10;
  for (int i = 0; i < 100; ++i) {
    field.position_px.push_back({15.5 + 32.0 * (i % 10), 15.5 + 32.0 * (i / 10)});
    field.displacement_px.push_back({1.0, 2.0});
    field.correlation.push_back(mean + (i % 2 == 0 ? scatter : -scatter));
    field.reason.push_back(VectorReason::measured);
    field.status.push_back(VectorStatus::valid);
  }
  return field;
}

CorrelationSettings windows_of_32() {
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.overlap = 0.0;
  return settings;
}

// Random correlation: 0.3 +- 0.1. The mean over 25 windows scatters by 0.02, at a corner over 9 windows by 0.033.
// Combined with the scatter of the mean over all 100, 0.01, two standard deviations are 0.045 and 0.07.
TEST(Chance, IsCorrelationOfUnrelatedFrames) {
  DisplacementField const chance = with_correlation(0.3, 0.1);
  for (auto const& [mean, left_out] : {std::pair{0.30, 100u}, {0.34, 100u}, {0.39, 0u}, {0.90, 0u}}) {
    DisplacementField field = with_correlation(mean, 0.0);
    reject_uncorrelated_vectors(field, chance, windows_of_32());
    EXPECT_EQ(count(field, VectorReason::uncorrelated), left_out) << mean;
    EXPECT_EQ(counting(field), 100u - left_out) << mean;
  }
}

// A corner of 4 x 4 good windows is less than a quarter of all: random correlation produces such a patch, too.
TEST(Chance, RejectsAllIfFewExceedIt) {
  for (auto const& [good, kept] : {std::pair{4, 0u}, {7, 49u}}) {
    DisplacementField field = with_correlation(0.1, 0.0);
    for (int j = 0; j < good; ++j)
      for (int i = 0; i < good; ++i) field.correlation[static_cast<std::size_t>(10 * j + i)] = 0.9;
    reject_uncorrelated_vectors(field, with_correlation(0.3, 0.1), windows_of_32());
    EXPECT_GE(counting(field), kept) << good;
    // The local mean extends over two windows to each side, so that at most 9 x 9 = 81 windows have good ones in it.
    EXPECT_LE(counting(field), kept * 2) << "windows next to the good ones may be kept too";
  }
}

TEST(Chance, PreservesOtherReasons) {
  DisplacementField field = with_correlation(0.3, 0.0);
  std::vector<VectorReason> const reasons{VectorReason::masked, VectorReason::no_signal, VectorReason::beyond_limit};
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    field.reason[i] = reasons[i];
    field.correlation[i] = std::numeric_limits<double>::quiet_NaN();
  }
  reject_uncorrelated_vectors(field, with_correlation(0.3, 0.1), windows_of_32());
  for (std::size_t i = 0; i < reasons.size(); ++i) EXPECT_EQ(field.reason[i], reasons[i]);
  EXPECT_EQ(count(field, VectorReason::uncorrelated), 97u);
}

}  // namespace
}  // namespace gladstone
