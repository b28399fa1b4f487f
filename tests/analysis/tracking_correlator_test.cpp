#include "analysis/tracking/tracking_correlator.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "analysis/tracking/dot_tracking.h"
#include "tests/analysis/synthetic_dots.h"

namespace gladstone::inline tracking {
namespace {

constexpr int frame_px = 256;

/// Front of 6 px displacement over 12 px at the middle of the frame: the gradient there is -0.5 px/px.
Vec2d front(Vec2d p) { return {-3 * std::tanh((p.x - 127.5) / 6), 0.5}; }

/// Errors of the valid vectors at least 12 px from the edge.
struct FieldError {
  double rms = 0;         ///< root mean square per component [px]
  double normalised = 0;  ///< root mean square of errors over their sigma_px [1]
  int count = 0;          ///< number of vectors
  int gross = 0;          ///< number of errors above 0.5 px
};

FieldError measure_error(DisplacementField const& field) {
  FieldError error;
  double squares = 0, normalised = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const middle = field.position_px[i];
    if (!field.counts(i) || middle.x < 12 || middle.y < 12 || middle.x > 243 || middle.y > 243) continue;
    Vec2d place = middle;  // vectors are at the mid-positions
    for (int step = 0; step < 30; ++step) place = middle - 0.5 * front(place);
    Vec2d const deviation = field.displacement_px[i] - front(place);
    squares += dot(deviation, deviation) / 2;
    if (!field.sigma_px.empty()) normalised += dot(deviation, deviation) / dot(field.sigma_px[i], field.sigma_px[i]);
    ++error.count;
    error.gross += length(deviation) > 0.5 ? 1 : 0;
  }
  error.rms = std::sqrt(squares / error.count);
  error.normalised = std::sqrt(normalised / error.count);
  return error;
}

// A front compresses a window of 24 px by a third of its width, but does not deform a dot.
TEST(TrackingCorrelator, ResolvesAFrontBetterThanCorrelation) {
  KeyedEngine random(31, RandomStream::target, 0);
  std::vector<Vec2d> const places = test::random_places(20 * 64, frame_px, 3, random);
  test::MovedDots const frames = test::moved_dots(frame_px, places, front, random);
  CorrelationSettings settings;
  settings.steep_passes = 0;  // repeated passes extrapolate into the front, so that windows resolve it better
  DisplacementField const correlated = make_correlator(settings)->correlate(frames.a, frames.b);
  settings.method = "tracking";
  DisplacementField const gridded = make_cpu_correlator(settings)->correlate(frames.a, frames.b);
  DisplacementField const dots = track_dots(frames.a, frames.b, correlated);
  FieldError const of_windows = measure_error(correlated), of_grid = measure_error(gridded),
                   of_dots = measure_error(dots);
  for (auto const& [name, error] : {std::pair{"windows", of_windows}, {"dots on the grid", of_grid}, {"dots", of_dots}})
    std::printf("%-18s %5d vectors  rms %.4f px  over sigma %.2f  gross %d\n", name, error.count, error.rms,
                error.normalised, error.gross);
  ASSERT_EQ(gridded.size(), correlated.size());
  EXPECT_GE(of_dots.count, 0.96 * 1280 * 232 * 232 / (256.0 * 256));
  EXPECT_LT(of_dots.rms, 0.25 * of_windows.rms);
  // A vector on the grid is interpolated from about three dots. At 20 dots per 32 x 32 px these share an area of 12 x
  // 12 px, which smooths the front less than a window of 24 x 24 px.
  EXPECT_LT(of_grid.rms, of_windows.rms);
}

/// Errors and yield of tracked dots in a uniform displacement.
struct Yield {
  double share = 0;  ///< of the dots in view, with a valid vector within half a pixel
  double rms_px = 0;
};

Yield measure_yield(DisplacementField const& field, Vec2d displacement, std::size_t dots) {
  double squares = 0, count = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const error = field.displacement_px[i] - displacement;
    if (!field.counts(i) || !(length(error) < 0.5)) continue;
    squares += dot(error, error) / 2;
    ++count;
  }
  return {count / static_cast<double>(dots), std::sqrt(squares / count)};
}

// 20 dots of 3 px at random places in 32 x 32 px: half of the images overlap. The known pattern determines the number
// of dots in each group of overlapping images.
TEST(TrackingCorrelator, ResolvesOverlapsOfAKnownPattern) {
  constexpr int side = 128;
  constexpr Vec2d moved{2.3, -0.7};
  KeyedEngine random(32, RandomStream::target, 0);
  std::vector<Vec2d> const places = test::random_places(20 * 16, side, 0.75, random);
  test::MovedDots const frames = test::moved_dots(
      side, places, [&](Vec2d) { return moved; }, random);
  std::size_t in_view = 0;
  for (Vec2d const p : places) in_view += p.x + moved.x < side - 0.5 && p.y + moved.y > -0.5;
  CorrelationSettings settings;
  settings.method = "tracking";
  settings.tracking.output = "scattered";
  Yield const found = measure_yield(make_cpu_correlator(settings)->correlate(frames.a, frames.b), moved, in_view);
  settings.known_dots_px = places;
  DisplacementField const field = make_cpu_correlator(settings)->correlate(frames.a, frames.b);
  Yield const known = measure_yield(field, moved, in_view);
  std::printf("found %.3f of the dots, rms %.4f px; known %.3f, rms %.4f px\n", found.share, found.rms_px, known.share,
              known.rms_px);
  EXPECT_GT(known.share, 0.97);
  EXPECT_GT(known.share, found.share);
  EXPECT_EQ(field.columns, 0);
  EXPECT_EQ(field.verdict.kind, PairVerdict::Kind::correlates);
}

// Unrelated frames have no displacement, on the grid and at the dots.
TEST(TrackingCorrelator, FindsNoDisplacementOfUnrelatedFrames) {
  KeyedEngine random(33, RandomStream::target, 0);
  auto const frame = [&] {
    std::vector<test::SyntheticDot> dots;
    for (Vec2d const p : test::random_places(20 * 16, 128, 2, random)) dots.push_back({p, 40000});
    return test::dot_image(128, dots, 2500, 400, random);
  };
  Image<double> const reference = frame(), flow = frame();
  CorrelationSettings settings;
  settings.method = "tracking";
  for (char const* output : {"grid", "scattered"}) {
    settings.tracking.output = output;
    DisplacementField const field = make_cpu_correlator(settings)->correlate(reference, flow);
    EXPECT_EQ(field.verdict.kind, PairVerdict::Kind::uncorrelated) << output;
    EXPECT_FALSE(field.warnings.empty()) << output;
    for (std::size_t i = 0; i < field.size(); ++i) EXPECT_FALSE(field.counts(i)) << output << ' ' << i;
  }
}

}  // namespace
}  // namespace gladstone::inline tracking
