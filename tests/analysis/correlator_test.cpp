#include "analysis/correlation/correlator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "analysis/correlation/standard_correlator.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

struct Score {
  double rms = 0.0;  // per component, over all vectors
  Vec2d bias;
  double worst = 0.0;
  std::size_t unknown = 0;
};

Score score(DisplacementField const& field, std::function<Vec2d(Vec2d)> const& truth, double border_px = 0.0,
            double image_px = 256.0) {
  Score result;
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const at = field.position_px[i];
    if (std::min(at.x, at.y) < border_px || std::max(at.x, at.y) > image_px - 1.0 - border_px) continue;
    if (!field.counts(i)) {
      ++result.unknown;
      continue;
    }
    Vec2d const error = field.displacement_px[i] - truth(at);
    squares += dot(error, error);
    result.bias += error;
    result.worst = std::max(result.worst, length(error));
    count += 1.0;
  }
  result.rms = std::sqrt(squares / (2.0 * count));
  result.bias = result.bias / count;
  return result;
}

CorrelationSettings with_windows(std::vector<int> windows) {
  CorrelationSettings settings;
  settings.window_px = std::move(windows);
  settings.overlap = 0.5;
  settings.median_epsilon_px = 0.1;
  return settings;
}

auto constant(double u, double v) {
  return [u, v](Vec2d) { return Vec2d{u, v}; };
}

TEST(InterrogationGrid, CentresOfEvenWindowsAreHalfIntegers) {
  InterrogationGrid const grid = final_grid(with_windows({32}), 100, 64);
  EXPECT_EQ(grid.columns, 5);
  EXPECT_EQ(grid.rows, 3);
  EXPECT_EQ(grid.centre(std::size_t{0}), (Vec2d{15.5, 15.5}));
  EXPECT_EQ(grid.centre(std::size_t{6}), (Vec2d{31.5, 31.5}));
  EXPECT_EQ(final_grid(with_windows({32}), 31, 64).size(), 0u);
}

// Required: 0.02 px without noise in one pass; the components have opposite signs.
TEST(SinglePass, MeasuresUniformShiftsOfBothSigns) {
  auto const correlator = make_correlator(with_windows({32}));
  double sum = 0.0;
  int cases = 0;
  for (double shift = -0.9; shift <= 1.01; shift += 0.2, ++cases) {
    auto const truth = constant(shift, -shift);
    ParticlePair const pair = render_particle_pair({}, truth);
    Score const result = score(correlator->correlate(pair.reference, pair.flow), truth);
    sum += result.rms * result.rms;
    EXPECT_EQ(result.unknown, 0u);
    EXPECT_LT(result.worst, 0.25) << shift << ": no vector on a wrong peak";
  }
  EXPECT_LT(std::sqrt(sum / cases), 0.02);
}

// Exchanging the images reverses the error, so bias(-d) = -bias(d).
TEST(SinglePass, PeakLockingCurveIsOdd) {
  auto const correlator = make_correlator(with_windows({32}));
  auto const bias = [&](double shift) {
    ParticleSettings const settings{.columns = 384, .rows = 384};
    ParticlePair const pair = render_particle_pair(settings, constant(shift, 0.0));
    return score(correlator->correlate(pair.reference, pair.flow), constant(shift, 0.0), 0.0, 384.0).bias.x;
  };
  // random error 0.014 px over about 130 independent windows: 0.0012 px; three standard deviations of a sum of two
  for (double const shift : {0.15, 0.3, 0.45}) EXPECT_NEAR(bias(shift), -bias(-shift), 0.005);
}

// Exchanging the images reverses the sign, up to single precision (1e-7 of the peak over its curvature), since windows
// share a transform.
TEST(SinglePass, ExchangedImagesGiveTheOppositeVector) {
  ParticlePair const pair = render_particle_pair({}, constant(0.35, -1.2));
  auto const correlator = make_correlator(with_windows({32}));
  DisplacementField const forward = correlator->correlate(pair.reference, pair.flow);
  DisplacementField const backward = correlator->correlate(pair.flow, pair.reference);
  for (std::size_t i = 0; i < forward.size(); ++i)
    EXPECT_LT(length(forward.displacement_px[i] + backward.displacement_px[i]), 1e-4);
}

/// Shear waves with an amplitude of 1 px: u varies along y, v along x.
auto wave(double length_px) {
  return [length_px](Vec2d p) {
    return Vec2d{std::sin(2.0 * pi * p.y / length_px), std::sin(2.0 * pi * p.x / length_px)};
  };
}

// Two windows and four vectors per wave: the median of the neighbours of a crest is 0 and must not replace it. The
// window itself averages: a Gaussian window of 32 px transmits exp(-pi/2 (32/64)^2) = 0.68 of a wave of 64 px, so that
// no error exceeds 0.32 sqrt(2) = 0.46 px, apart from noise and the shape of the peak.
TEST(SinglePass, KeepsTheCrestsOfAWaveOfTwoWindows) {
  for (double const noise : {0.0, 0.05}) {
    ParticlePair const pair = render_particle_pair({.noise = noise}, wave(64.0));
    DisplacementField const field = make_correlator(with_windows({32}))->correlate(pair.reference, pair.flow);
    Score const result = score(field, wave(64.0), 32.0);
    EXPECT_LT(result.worst, 1.0);
    EXPECT_LT(result.rms, 0.35);
    auto const replaced = std::count(field.status.begin(), field.status.end(), VectorStatus::replaced);
    EXPECT_LE(replaced, static_cast<std::ptrdiff_t>(field.size() / 100));

    CorrelationSettings strict = with_windows({32});
    strict.trusted_peak_ratio.reset();
    DisplacementField const cut = make_correlator(strict)->correlate(pair.reference, pair.flow);
    EXPECT_GT(std::count(cut.status.begin(), cut.status.end(), VectorStatus::replaced),
              static_cast<std::ptrdiff_t>(cut.size() / 4))
        << "the comparison with neighbours alone rejects these vectors";
    EXPECT_EQ(std::memcmp(cut.raw_px.data(), field.raw_px.data(), cut.size() * sizeof(Vec2d)), 0);
  }
}

// Within the search range of 4 px of the later passes a random peak hardly leaves room for a secondary peak: at 5 %
// noise, accepting such windows would keep vectors with errors of 0.5 px and more among those with errors of 0.05 px.
TEST(MultiPass, TrustsTheFirstPassAlone) {
  CorrelationSettings const settings;
  CorrelationSchedule const schedule(settings);
  EXPECT_EQ(schedule.rule(0).reliable_peak_ratio, 2.0);
  EXPECT_EQ(schedule.rule(1).reliable_peak_ratio, std::numeric_limits<double>::infinity());
  int const last = schedule.passes() - 1;
  EXPECT_EQ(schedule.rule(last).reliable_peak_ratio, std::numeric_limits<double>::infinity());
  EXPECT_EQ(schedule.rule(last).epsilon_px, settings.median_epsilon_px);
  EXPECT_EQ(schedule.rule(last - 1).epsilon_px, 0.5);
}

// Noise of 10 % and five dots per window: one vector in thirty is a gross error, mostly because an earlier pass was
// wrong. With the test of whole displacements a third fewer of the measured vectors are gross errors
// (docs/estimators.md: 1024 x 1024 px).
TEST(MultiPass, JudgesWholeDisplacements) {
  auto const truth = constant(0.4, -0.4);
  ParticlePair const pair = render_particle_pair(
      {.columns = 512, .rows = 512, .particles_per_px = 5.0 / 1024.0, .noise = 0.1, .seed = 9}, truth);
  auto const gross = [&](std::optional<double> threshold) {
    CorrelationSettings settings;
    settings.displacement_threshold = threshold;
    DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    std::ptrdiff_t count = 0;
    for (std::size_t i = 0; i < field.size(); ++i)
      count += field.status[i] == VectorStatus::valid && length(field.displacement_px[i] - truth({})) > 1.0;
    return count;
  };
  std::ptrdiff_t const without = gross({});
  EXPECT_GT(without, 60);
  EXPECT_LT(static_cast<double>(gross(2.0)), 0.8 * static_cast<double>(without));
}

// Nodes 26, 13, 10 and 8 px apart: the product of smoothing fraction and spacing is the same for all predictors, and
// the frames are deformed by predictors that are smoothed no more than the last one.
TEST(MultiPass, SmoothsWiderGridsLess) {
  CorrelationSettings settings;
  settings.window_px = {64, 32, 24, 20};
  settings.overlap = 0.6;
  CorrelationSchedule const schedule(settings);
  EXPECT_DOUBLE_EQ(schedule.smoothing(0), 0.25 * 10.0 / 26.0);
  EXPECT_DOUBLE_EQ(schedule.smoothing(1), 0.25 * 10.0 / 13.0);
  EXPECT_EQ(schedule.smoothing(2), 0.25);
  EXPECT_EQ(schedule.smoothing(3), 0.25);
  settings.window_px = {32};
  EXPECT_EQ(CorrelationSchedule(settings).smoothing(0), 0.25);
}

// The measured displacement is retained when a vector is replaced.
TEST(Correlator, KeepsTheRawVectorOfEveryWindow) {
  auto const truth = constant(2.3, -0.2);
  ParticlePair const pair = render_particle_pair({.particles_per_px = 6.0 / 1024.0, .noise = 0.1}, truth);
  DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
  std::size_t replaced = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    bool const as_measured = field.reason[i] == VectorReason::measured;
    EXPECT_EQ(as_measured, field.status[i] == VectorStatus::valid);
    EXPECT_EQ(as_measured, field.counts(i) && field.raw_px[i] == field.displacement_px[i]) << i;
    EXPECT_GT(field.correlation[i], 0.0);
    EXPECT_LE(field.correlation[i], 1.0);
    replaced += field.status[i] == VectorStatus::replaced;
  }
  EXPECT_GT(replaced, 0u);
}

// The square lattice matches itself at every whole pitch. Of all shifts that fit, the smallest is selected: up to 0.45
// pitch along both axes it is correct in every window, and each vector is marked as ambiguous.
TEST(RegularDots, AreRightUpToNearlyHalfAPitch) {
  for (double const pitch : {5.7, 7.155, 10.0, 13.3})
    for (double const part : {0.07, 0.25, 0.45}) {
      auto const truth = constant(part * pitch, -part * pitch);
      ParticlePair const pair =
          render_particle_pair({.columns = 128, .rows = 128, .noise = 0.02, .pitch_px = pitch}, truth);
      for (std::vector<int> const& windows : {std::vector<int>{32}, {64, 32, 16}}) {
        DisplacementField const field = make_correlator(with_windows(windows))->correlate(pair.reference, pair.flow);
        Score const result = score(field, truth, 0.0, 128.0);
        EXPECT_EQ(result.unknown, 0u);
        EXPECT_LT(result.worst, 0.3) << pitch << ' ' << part << ' ' << windows.size() << " passes";
        EXPECT_EQ(std::count(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::none), 0) << pitch;
      }
    }
}

// Beyond half a pitch an alias is a smaller shift. The vectors are then wrong, but marked as ambiguous.
TEST(RegularDots, AreAmbiguousBeyondHalfAPitch) {
  ParticlePair const pair = render_particle_pair({.columns = 128, .rows = 128, .pitch_px = 7.155}, constant(4.3, 0.0));
  DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
  EXPECT_EQ(std::count(field.ambiguous.begin(), field.ambiguous.end(), Ambiguity::none), 0);
  EXPECT_LT(score(field, constant(4.3 - 7.155, 0.0), 0.0, 128.0).worst, 0.1);
}

TEST(MaxDisplacement, ChoosesAmongAliases) {
  // 4.3 px is 0.6 pitch along x; only the alias at -2.855 px is within 3 px, and only 4.3 - 14.31 and so on beyond it
  ParticlePair const pair = render_particle_pair({.columns = 128, .rows = 128, .pitch_px = 7.155}, constant(4.3, 0.0));
  CorrelationSettings settings;
  settings.max_displacement_px = 3.0;
  DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
  for (std::size_t i = 0; i < field.size(); ++i) {
    EXPECT_NEAR(field.displacement_px[i].x, 4.3 - 7.155, 0.1);
    EXPECT_EQ(field.ambiguous[i], Ambiguity::none) << "only one displacement is within the limit";
  }
}

// Along either axis, including the predictor of earlier passes, in every pass.
TEST(MaxDisplacement, IsHonouredByEveryVector) {
  auto const truth = [](Vec2d p) { return Vec2d{0.04 * (p.x - 128.0), 3.0}; };  // -5.1 .. 5.1 px
  ParticlePair const pair = render_particle_pair({}, truth);
  CorrelationSettings settings;
  settings.max_displacement_px = 3.6;
  DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const raw = field.raw_px[i];
    if (!std::isnan(raw.x)) {
      EXPECT_LE(std::max(std::abs(raw.x), std::abs(raw.y)), 3.6);
    }
    if (field.counts(i)) {
      EXPECT_LE(std::abs(field.displacement_px[i].x), 3.6);
    }
    double const expected = std::abs(truth(field.position_px[i]).x);
    if (expected < 2.5) {
      EXPECT_LT(length(field.displacement_px[i] - truth(field.position_px[i])), 0.2);
    }
    if (expected > 4.2) beyond += field.reason[i] == VectorReason::beyond_limit;
  }
  EXPECT_GT(beyond, 0u);
  settings.max_displacement_px = 6.0;
  EXPECT_LT(score(make_correlator(settings)->correlate(pair.reference, pair.flow), truth).worst, 0.2);
}

// The default of OpenPIV has an error of 0.0083 px on such images; ours must be smaller, including the vectors at the
// border of the image.
TEST(MultiPass, BeatsEightMillipixelsOnUniformShifts) {
  auto const correlator = make_correlator({});
  double sum = 0.0;
  for (double const shift : {-0.6, 0.0, 0.3, 0.5, 5.3}) {
    auto const truth = constant(shift, -shift);
    ParticlePair const pair = render_particle_pair({}, truth);
    Score const result = score(correlator->correlate(pair.reference, pair.flow), truth);
    EXPECT_EQ(result.unknown, 0u);
    EXPECT_LT(std::abs(result.bias.x), 0.005) << shift;
    EXPECT_LT(std::abs(result.bias.y), 0.005) << shift;
    sum += result.rms * result.rms;
  }
  EXPECT_LT(std::sqrt(sum / 5.0), 0.0083);
}

// With cubic splines the deformation has a larger error (0.0079 instead of 0.0026 px on 1024 x 1024 px).
TEST(MultiPass, CubicDeformationStaysBelowOneAndAHalfHundredths) {
  CorrelationSettings settings;
  settings.deformation = "cubic";
  auto const truth = constant(0.3, -0.3);
  ParticlePair const pair = render_particle_pair({}, truth);
  EXPECT_LT(score(make_correlator(settings)->correlate(pair.reference, pair.flow), truth).rms, 0.015);
}

// The sinc over eight pixels has a smaller error than the quintic spline (0.0023 instead of 0.0030 px on 1024 x 1024
// px), half as much again for 256 px.
TEST(MultiPass, SincDeformationErrsByThousandths) {
  CorrelationSettings settings;
  settings.deformation = "sinc";
  auto const truth = constant(0.3, -0.3);
  ParticlePair const pair = render_particle_pair({}, truth);
  EXPECT_LT(score(make_correlator(settings)->correlate(pair.reference, pair.flow), truth).rms, 0.0035);
}

// The Cramer-Rao bound for 16 px windows at 5 % noise is 0.039 px.
TEST(MultiPass, HasNoGrossErrorsAtFivePercentNoise) {
  auto const truth = constant(0.4, -0.4);
  ParticlePair const pair = render_particle_pair({.noise = 0.05}, truth);
  Score const result = score(make_correlator({})->correlate(pair.reference, pair.flow), truth);
  EXPECT_LT(result.rms, 0.06);
  EXPECT_LT(result.worst, 1.0);
}

// u = g (y - y0): a position error of half a pixel appears as a mean error of g/2 = 0.01 px in u.
TEST(MultiPass, PutsShearAtTheWindowCentreAfterOneToFivePasses) {
  auto const truth = [](Vec2d p) { return Vec2d{0.02 * (p.y - 100.0), 0.0}; };
  ParticlePair const pair = render_particle_pair({}, truth);
  for (std::vector<int> const& windows :
       {std::vector<int>{32}, {32, 32}, {64, 32, 16}, {64, 32, 16, 16}, {64, 32, 32, 16, 16}}) {
    Score const result = score(make_correlator(with_windows(windows))->correlate(pair.reference, pair.flow), truth);
    EXPECT_EQ(result.unknown, 0u);
    // one pass: random error 0.026 px over about 60 independent windows is 0.0034 px; later passes 0.0025 px over 256
    EXPECT_LT(std::abs(result.bias.x), windows.size() == 1 ? 0.009 : 0.002) << windows.size() << " passes";
    // the second of two passes still compensates for rigid windows, and a quarter of its vectors are at the border
    EXPECT_LT(result.rms, windows.size() == 1 ? 0.04 : (windows.size() == 2 ? 0.015 : 0.008)) << windows.size();
  }
}

TEST(MultiPass, KeepsTheAmplitudeOfASineOfFourWindows) {
  auto const truth = [](Vec2d p) { return Vec2d{std::sin(2.0 * pi * p.y / 64.0), std::sin(2.0 * pi * p.x / 64.0)}; };
  ParticlePair const pair = render_particle_pair({}, truth);
  DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
  double product = 0.0, square = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const expected = truth(field.position_px[i]);
    product += dot(field.displacement_px[i], expected);
    square += dot(expected, expected);
  }
  EXPECT_GT(product / square, 0.9);
  EXPECT_LT(product / square, 1.02);
}

// A wave of four windows with an amplitude of 1.5 px: at the edge the predictor is extrapolated from the interior, so
// that the increments of correct vectors differ from those of their neighbours. Replacement must not increase the error
// by more than chance does: 3 % of the rms error (29 % without the test of the sums), and no new gross errors.
TEST(MultiPass, ReplacementDoesNotDegradeVectorsAtTheEdgeOfASine) {
  auto const truth = [](Vec2d p) {
    return Vec2d{1.5 * std::sin(2.0 * pi * p.y / 64.0), 1.5 * std::sin(2.0 * pi * p.x / 64.0)};
  };
  double raw = 0.0, given = 0.0;
  int raw_gross = 0, given_gross = 0;
  for (std::uint64_t const seed : {1, 2, 3, 4}) {
    ParticlePair const pair = render_particle_pair({.columns = 200, .rows = 200, .seed = seed}, truth);
    DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
    for (std::size_t i = 0; i < field.size(); ++i) {
      Vec2d const right = truth(field.position_px[i]);
      double const raw_error = length(field.raw_px[i] - right), error = length(field.displacement_px[i] - right);
      raw += raw_error * raw_error;
      given += error * error;
      raw_gross += raw_error > 1.0;
      given_gross += error > 1.0;
    }
  }
  EXPECT_LT(std::sqrt(given / raw), 1.06);
  EXPECT_LE(given_gross, raw_gross + 3);
}

TEST(Correlator, GivesTheSameBitsForAnyNumberOfThreads) {
  ParticlePair const pair = render_particle_pair({.columns = 200, .rows = 168, .noise = 0.05}, constant(2.3, -1.1));
  auto const correlator = make_correlator({});
  int const before = thread_count();
  set_thread_count(1);
  DisplacementField const alone = correlator->correlate(pair.reference, pair.flow);
  for (int const threads : {2, 7}) {
    set_thread_count(threads);
    DisplacementField const together = correlator->correlate(pair.reference, pair.flow);
    EXPECT_EQ(alone.displacement_px, together.displacement_px);
    EXPECT_EQ(alone.peak_ratio, together.peak_ratio);
    EXPECT_EQ(alone.status, together.status);
  }
  set_thread_count(before);
}

TEST(Correlator, CallsFlatImagesInvalid) {
  Image<double> const flat(128, 128, 100.0);
  for (std::vector<int> const& windows : {std::vector<int>{32}, {64, 32, 16}}) {
    DisplacementField const field = make_correlator(with_windows(windows))->correlate(flat, flat);
    ASSERT_GT(field.size(), 0u);
    for (std::size_t i = 0; i < field.size(); ++i) {
      EXPECT_EQ(field.status[i], VectorStatus::invalid);
      EXPECT_TRUE(std::isnan(field.displacement_px[i].x) && std::isnan(field.displacement_px[i].y));
    }
  }
}

// If the nominal window is black in both images, there is nothing to measure; if it is completely illuminated, the
// vectors are as accurate as elsewhere (noise-free rms 0.0083 px), except within the range of the Gaussian weights from
// the edge.
TEST(Correlator, MeasuresTheLitHalfOfAnImage) {
  auto const truth = constant(0.3, 0.6);
  ParticlePair pair = render_particle_pair({}, truth);
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (int j = 0; j < 256; ++j)
      for (int i = 128; i < 256; ++i) (*image)(i, j) = 0.0;
  DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const x = field.position_px[i].x;
    if (x > 128.0 + 32.0) {
      EXPECT_EQ(field.status[i], VectorStatus::invalid) << x;
    }
    if (x < 128.0 - 32.0) {
      EXPECT_TRUE(field.counts(i));
      Vec2d const error = field.displacement_px[i] - truth({});
      squares += dot(error, error);
      count += 2.0;
    }
  }
  EXPECT_LT(std::sqrt(squares / count), 0.0083);
}

TEST(Correlator, MasksWindowsOfUnknownPixels) {
  auto const truth = constant(0.3, 0.6);
  ParticlePair pair = render_particle_pair({}, truth);
  for (int j = 0; j < 256; ++j)
    for (int i = 160; i < 256; ++i) pair.flow(i, j) = std::numeric_limits<double>::quiet_NaN();
  DisplacementField const field = make_correlator({})->correlate(pair.reference, pair.flow);
  for (std::size_t i = 0; i < field.size(); ++i) {
    double const x = field.position_px[i].x;
    if (x > 168.0) {
      EXPECT_EQ(field.status[i], VectorStatus::masked) << x;
    }
    if (x < 152.0) {
      EXPECT_TRUE(field.counts(i)) << x;
      EXPECT_LT(length(field.displacement_px[i] - truth({})), 0.1) << x;
    }
  }
}

// Only differences of grey levels matter: 12-bit images on a high background give the same as 8-bit images, up to the
// float rounding of the B-spline (1e-7 of the range, some 1e-5 px).
TEST(Correlator, IgnoresGainAndOffsetOfTheGreyLevels) {
  ParticlePair pair = render_particle_pair({}, constant(1.3, 0.2));
  auto const correlator = make_correlator({});
  DisplacementField const plain = correlator->correlate(pair.reference, pair.flow);
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (double& value : *image) value = 50000.0 + 16.0 * value;
  DisplacementField const shifted = correlator->correlate(pair.reference, pair.flow);
  for (std::size_t i = 0; i < plain.size(); ++i)
    EXPECT_LT(length(plain.displacement_px[i] - shifted.displacement_px[i]), 1e-3);
}

TEST(Correlator, SmallestAndUniformWindowsWork) {
  auto const truth = constant(0.4, -0.3);
  ParticlePair const pair = render_particle_pair({.columns = 64, .rows = 64, .particles_per_px = 0.06}, truth);
  CorrelationSettings settings = with_windows({32, 4});
  settings.overlap = 0.0;
  EXPECT_EQ(make_correlator(settings)->correlate(pair.reference, pair.flow).size(), 256u);
  settings.window_px = {32};
  settings.overlap = 0.5;
  settings.weighting = "uniform";
  Score const result = score(make_correlator(settings)->correlate(pair.reference, pair.flow), truth);
  EXPECT_LT(result.worst, 0.3);
}

TEST(Correlator, RefusesImagesThatDoNotSuit) {
  auto const correlator = make_correlator({});
  EXPECT_THAT([&] { correlator->correlate(Image<double>(128, 128), Image<double>(128, 127)); },
              ThrowsDataError(ErrorCode::wrong_shape, "image pair"));
  EXPECT_THAT([&] { correlator->correlate(Image<double>(63, 128), Image<double>(63, 128)); },
              ThrowsDataError(ErrorCode::wrong_shape, "image pair"));
}

TEST(CorrelationSettings, WindowLargerThanTheImageIsAProblem) {
  EXPECT_TRUE(window_problem({}, 64, 64).empty());
  EXPECT_NE(window_problem({}, 64, 63).find("64 px"), std::string::npos);
}

}  // namespace
}  // namespace gladstone
