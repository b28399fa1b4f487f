#include "analysis/tracking/dot_matching.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "analysis/tracking/dot_tracking.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "tests/analysis/synthetic_dots.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline tracking {
namespace {

constexpr double side = 400;

/// Places in two frames; partner[i] is the index in frame B, or -1.
struct TwoFrames {
  std::vector<Vec2d> a, b;
  std::vector<int> partner;
};

/// Random places, shifted by a field; a share of the particles is lost and replaced by others.
template <class Field>
TwoFrames random_frames(double spacing, double lost, Field const& field) {
  KeyedEngine random(3, RandomStream::particles, 1);
  auto const count = static_cast<std::size_t>(side * side / (spacing * spacing));
  TwoFrames frames;
  frames.a = test::random_places(count, side, 0, random);
  for (Vec2d const p : frames.a) {
    Vec2d const q = p + field(p);
    bool const visible = to_unit(random()) >= lost && q.x >= 0 && q.y >= 0 && q.x < side && q.y < side;
    frames.partner.push_back(visible ? static_cast<int>(frames.b.size()) : -1);
    if (visible) frames.b.push_back(q + 0.02 * Vec2d{normal_variate(random), normal_variate(random)});
  }
  auto const strays = static_cast<std::size_t>(lost * static_cast<double>(count));
  for (Vec2d const p : test::random_places(strays, side, 0, random)) frames.b.push_back(p);
  return frames;
}

/// Fractions of the dots with a partner; wrong matches of dots without a partner count as well.
struct Shares {
  double right = 0, wrong = 0, ambiguous = 0;
};

Shares count_shares(TwoFrames const& frames, std::vector<DotMatch> const& matches) {
  Shares shares;
  double count = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    bool const matched = matches[i].status == MatchStatus::matched;
    if (frames.partner[i] < 0) {
      shares.wrong += matched ? 1 : 0;
      continue;
    }
    ++count;
    bool const right = static_cast<int>(matches[i].partner) == frames.partner[i];
    shares.right += matched && right ? 1 : 0;
    shares.wrong += matched && !right ? 1 : 0;
    shares.ambiguous += matches[i].status == MatchStatus::ambiguous ? 1 : 0;
  }
  shares.right /= count;
  shares.wrong /= count;
  shares.ambiguous /= count;
  return shares;
}

/// Sine in both components with the largest gradient g over 80 px, plus a shift along x.
auto sine_field(double shift, double g) {
  return [=](Vec2d p) {
    constexpr double k = 2 * pi / 80;
    return Vec2d{shift + g / k * std::sin(k * p.y), g / k * std::sin(k * p.x)};
  };
}

// Fraction of right matches over the ratio of displacement and spacing, without a predictor and with a fifth of the
// particles lost. A nearest-neighbour search fails from a ratio of 0.5 on.
TEST(DotMatching, FindsPartnersFarBeyondTheSpacing) {
  constexpr double spacing = 7;
  std::printf("   lost  ratio   right   wrong   ambiguous\n");
  for (double const lost : {0.0, 0.2})
    for (double const ratio : {0.1, 0.25, 0.5, 1.0, 2.0, 3.0}) {
      TwoFrames const frames = random_frames(spacing, lost, sine_field(ratio * spacing, 0.05));
      MatchSettings settings;
      settings.search_radius_px = 1.2 * ratio * spacing + 2;
      Shares const shares = count_shares(frames, match_dots(frames.a, frames.b, {}, settings));
      std::printf("%7.2f %6.2f %7.3f %7.3f %7.3f\n", lost, ratio, shares.right, shares.wrong, shares.ambiguous);
      EXPECT_GT(shares.right, 0.95) << ratio << ", lost " << lost;
      EXPECT_LT(shares.wrong, 0.02) << ratio << ", lost " << lost;
    }
}

// Gradients of 0.3 px/px, with the true field, disturbed by 0.5 px, as the prediction.
TEST(DotMatching, FollowsSteepGradientsByThePrediction) {
  auto const field = sine_field(10, 0.3);
  TwoFrames const frames = random_frames(7, 0.1, field);
  std::vector<Vec2d> prediction;
  for (Vec2d const p : frames.a) prediction.push_back(field(p) + Vec2d{0.5, -0.5});
  MatchSettings settings;
  settings.search_radius_px = 2;
  Shares const shares = count_shares(frames, match_dots(frames.a, frames.b, prediction, settings));
  EXPECT_GT(shares.right, 0.96);
  EXPECT_LT(shares.wrong, 0.02);
}

/// Square grid of dots in both frames, cut off by the edges of the frames.
TwoFrames regular_frames(double pitch, Vec2d shift) {
  TwoFrames frames;
  KeyedEngine random(5, RandomStream::target, 0);
  for (double y = 0.4 * pitch; y < side; y += pitch)
    for (double x = 0.4 * pitch; x < side; x += pitch) frames.a.push_back({x, y});
  std::vector<Vec2d> shifted;
  for (double y = 0.4 * pitch - 4 * pitch; y < side + 4 * pitch; y += pitch)
    for (double x = 0.4 * pitch - 4 * pitch; x < side + 4 * pitch; x += pitch) {
      Vec2d const q = Vec2d{x, y} + shift;
      bool const visible = q.x >= 0 && q.y >= 0 && q.x < side && q.y < side;
      if (visible) frames.b.push_back(q + 0.02 * Vec2d{normal_variate(random), normal_variate(random)});
    }
  for (Vec2d const p : frames.a) {
    int found = -1;
    for (std::size_t k = 0; k < frames.b.size(); ++k)
      if (length(frames.b[k] - p - shift) < 0.2) found = static_cast<int>(k);
    frames.partner.push_back(found);
  }
  return frames;
}

// A grid that is shifted by s or by s plus its pitch looks the same: no match is certain, whatever the search radius.
TEST(DotMatching, RegularDotsGiveNoSilentAlias) {
  constexpr double pitch = 10;
  for (double const radius : {0.0, 3.0, 6.0})
    for (double const shift : {0.5, 0.6, 0.9, 1.0, 1.4}) {
      TwoFrames const frames = regular_frames(pitch, {shift * pitch, 0.1 * pitch});
      MatchSettings settings;
      settings.search_radius_px = radius;
      EXPECT_EQ(count_shares(frames, match_dots(frames.a, frames.b, {}, settings)).wrong, 0) << shift << ", " << radius;
    }
}

// A bound of the displacement below half the pitch makes the match unique.
TEST(DotMatching, RegularDotsAreMatchedWithinAStatedBound) {
  TwoFrames const frames = regular_frames(10, {3.5, -2});
  MatchSettings settings;
  settings.displacement_bound_px = 4.9;
  Shares const shares = count_shares(frames, match_dots(frames.a, frames.b, {}, settings));
  EXPECT_GT(shares.right, 0.97);
  EXPECT_EQ(shares.wrong, 0);
}

TEST(DotMatching, AcceptsFramesWithoutDotsAndPlacesThatAreNotFinite) {
  EXPECT_TRUE(match_dots({}, {}, {}).empty());
  std::vector<Vec2d> const few{{1, 1}, {not_a_number, 2}, {5, 5}};
  EXPECT_EQ(match_dots(few, {}, {}).size(), 3u);
  auto const matches = match_dots(few, few, {});
  EXPECT_EQ(matches[1].status, MatchStatus::unmatched);
}

// 20 dots of 3 px per 32x32 px, without overlap and at random places.
TEST(DotTracking, GivesNearlyEveryDotAVector) {
  auto const field = sine_field(1.3, 0.05);
  for (double const apart : {3.0, 0.0}) {
    KeyedEngine random(21, RandomStream::target, 2);
    std::vector<Vec2d> const places = test::random_places(720, 192, apart, random);
    test::MovedDots const frames = test::moved_dots(192, places, field, random);
    DisplacementField const vectors = track_dots(frames.a, frames.b, {});
    int all = 0, found = 0, gross = 0;
    std::vector<char> used(vectors.size());  // a vector counts for one dot only
    for (Vec2d const p : places) {
      if (p.x < 6 || p.y < 6 || p.x > 185 || p.y > 185) continue;
      ++all;
      Vec2d const middle = p + 0.5 * field(p);
      double nearest = 0.5, error = 0;
      std::size_t own = vectors.size();
      for (std::size_t i = 0; i < vectors.size(); ++i) {
        if (used[i] || !vectors.counts(i) || !(length(vectors.position_px[i] - middle) < nearest)) continue;
        nearest = length(vectors.position_px[i] - middle);
        error = length(vectors.displacement_px[i] - field(p));
        own = i;
      }
      bool const any = own < vectors.size();
      if (any) used[own] = 1;
      found += any && error < 0.5 ? 1 : 0;
      gross += any && error >= 0.5 ? 1 : 0;
    }
    std::printf("at least %.0f px apart: yield %.4f of %d, gross errors %d\n", apart, static_cast<double>(found) / all,
                all, gross);
    EXPECT_GE(found, 0.98 * all) << apart;
    EXPECT_LE(gross, 0.005 * all) << apart;
  }
}

TEST(DotTracking, RefusesFramesOfDifferentSize) {
  EXPECT_THAT([&] { track_dots(Image<double>(32, 32), Image<double>(32, 33), {}); },
              ThrowsDataError(ErrorCode::wrong_shape, "frame B"));
}

TEST(DotTracking, StatesUncertaintyAndStatusOfEveryMatch) {
  LocatedDots a, b;
  a.dots.resize(4);
  b.dots.resize(1);
  a.dots[0].sigma_px = {0.03, 0.03};
  b.dots[0].sigma_px = {0.04, 0.04};
  b.dots[0].image.centre = {1, 2};
  std::vector<DotMatch> const matches{{0, MatchStatus::matched, 0.9, 0.3},
                                      {0, MatchStatus::ambiguous, 0.9, 0.9},
                                      {0, MatchStatus::outlier, 0.9, 0.3},
                                      {0, MatchStatus::unmatched, 0, 0}};
  DisplacementField const field = matched_vectors(a, b, matches);
  ASSERT_EQ(field.size(), 4u);
  EXPECT_EQ(field.position_px[0], (Vec2d{0.5, 1}));
  EXPECT_EQ(field.displacement_px[0], (Vec2d{1, 2}));
  EXPECT_NEAR(field.sigma_px[0].x, 0.05, 1e-12);
  EXPECT_NEAR(field.peak_ratio[0], 3, 1e-12);
  EXPECT_EQ(field.ambiguous[1], Ambiguity::here);
  EXPECT_EQ(field.failed[2], FailedTest::median);
  EXPECT_EQ(field.reason[3], VectorReason::beyond_limit);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(field.counts(i), i == 0);
}

}  // namespace
}  // namespace gladstone::inline tracking
