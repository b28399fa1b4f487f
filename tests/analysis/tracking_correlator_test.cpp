#include "analysis/tracking/tracking_correlator.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/analysis/synthetic_dots.h"

namespace gladstone::tracking {
namespace {

constexpr int frame_px = 256;

/// Front of 6 px displacement over 12 px at the middle of the frame: the gradient there is -0.5 px/px.
Vec2d front(Vec2d p) { return {-3 * std::tanh((p.x - 127.5) / 6), 0.5}; }

/// Root mean square of the errors of both components over the vectors that count, at least 12 px from the edge.
struct FieldError {
  double rms = 0, normalised = 0;
  int count = 0, gross = 0;
};

FieldError error_of(DisplacementField const& field) {
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

// A front compresses a window of 24 px by a third of its width; a dot moves as a whole.
TEST(TrackingCorrelator, ResolvesAFrontBetterThanCorrelation) {
  KeyedEngine random(31, RandomStream::target, 0);
  std::vector<test::SyntheticDot> a, b;
  for (Vec2d const p : test::random_places(20 * 64, frame_px, 3, random)) {
    a.push_back({p, 40000});
    b.push_back({p + front(p), 40000});
  }
  Image<double> const reference = test::dot_image(frame_px, a, 2500, 400, random);
  Image<double> const flow = test::dot_image(frame_px, b, 2500, 400, random);
  CorrelationSettings const settings;
  DisplacementField const correlated = make_correlator(settings)->correlate(reference, flow);
  DisplacementField const gridded = make_tracking_correlator(settings)->correlate(reference, flow);
  DisplacementField const dots = track_dots(reference, flow, correlated);
  FieldError const of_windows = error_of(correlated), of_grid = error_of(gridded), of_dots = error_of(dots);
  for (auto const& [name, error] : {std::pair{"windows", of_windows}, {"dots on the grid", of_grid}, {"dots", of_dots}})
    std::printf("%-18s %5d vectors  rms %.4f px  over sigma %.2f  gross %d\n", name, error.count, error.rms,
                error.normalised, error.gross);
  ASSERT_EQ(gridded.size(), correlated.size());
  EXPECT_GE(of_dots.count, 0.96 * 1280 * 232 * 232 / (256.0 * 256));
  EXPECT_LT(of_dots.rms, 0.25 * of_windows.rms);
  EXPECT_LT(of_grid.rms, of_windows.rms);
}

}  // namespace
}  // namespace gladstone::tracking
