#include "analysis/tracking/track_evidence.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "analysis/tracking/dot_matching.h"
#include "analysis/tracking/dot_tracking.h"
#include "tests/analysis/synthetic_dots.h"

namespace gladstone::inline tracking {
namespace {

// Positions x, x + v, x + 2 v + c, x + 3 v + 3 c of constant acceleration c are extrapolated exactly; a third
// difference of one tolerance gives exp(-1/2). With one neighbour, the acceleration itself is the misfit.
TEST(TrackEvidence, IsThatOfThePolynomialThroughThreePositions) {
  Vec2d const v{8, -3}, c{0.5, 1}, x{40, 50};
  std::vector<Vec2d> const before{x, {90, 90}}, after{x + 3 * v + 3 * c, {10, 80}};
  Vec2d const place = x + v, displacement = v + c;
  EXPECT_NEAR(TrackEvidence({before, after}, 2, 0.5).evaluate(place, displacement), 1, 1e-12);
  // Another displacement d changes the extrapolation by 3 d.
  Vec2d const d{0.5 / 3, 0};
  EXPECT_NEAR(TrackEvidence({before, after}, 2, 0.5).evaluate(place, displacement + d), std::exp(-0.5), 1e-12);
  EXPECT_EQ(TrackEvidence({before, after}, 1, 0.5).evaluate(place, displacement), 0) << "acceleration above the limit";
  double const misfit = length(c);
  EXPECT_NEAR(TrackEvidence({before, {}}, 2, 0.5).evaluate(place, displacement), std::exp(-2 * misfit * misfit), 1e-12);
  EXPECT_NEAR(TrackEvidence({{}, after}, 2, 0.5).evaluate(place, displacement), std::exp(-2 * misfit * misfit), 1e-12);
  EXPECT_EQ(TrackEvidence({}, 2, 0.5).evaluate(place, displacement), 0);
}

constexpr double side = 256, spacing = 7, core = 8 * spacing;

/// Vortex with the angular velocity 2 q / (1 + r^2 / core^2) / core: the largest velocity is q, at the core radius. In
/// a thick light sheet, velocities differ with depth, by a factor of each particle.
struct Vortex {
  double q = 0;         ///< largest displacement per interval [px]
  double spread = 0.3;  ///< largest deviation of the factors from 1
  Vec2d position(Vec2d p, double time) const {
    constexpr Vec2d centre{0.5 * side, 0.5 * side};
    Vec2d const r = p - centre;
    double const angle = 2 * q / core / (1 + dot(r, r) / (core * core)) * time;
    return centre + Vec2d{std::cos(angle) * r.x - std::sin(angle) * r.y, std::sin(angle) * r.x + std::cos(angle) * r.y};
  }
};

/// Particles of four frames; a tenth of those of each frame is lost and replaced by others.
struct FourFrames {
  std::array<std::vector<Vec2d>, 4> places;
  std::vector<int> partner;       ///< of the particles of frame 1: index in frame 2, or -1
  std::vector<Vec2d> prediction;  ///< of the particles of frame 1: mean displacement over a window of 32 px
};

FourFrames make_frames(Vortex const& vortex, std::uint64_t seed) {
  constexpr double lost = 0.1, noise = 0.05;
  KeyedEngine random(seed, RandomStream::particles, 1);
  auto const count = static_cast<std::size_t>(side * side / (spacing * spacing));
  std::vector<Vec2d> const start = test::random_places(count, side, 0, random);
  std::vector<double> factor;
  for (std::size_t n = 0; n < count; ++n) factor.push_back(1 + vortex.spread * (2 * to_unit(random()) - 1));
  FourFrames frames;
  std::array<std::vector<int>, 4> index;
  for (std::size_t f = 0; f < 4; ++f)
    for (std::size_t n = 0; n < count; ++n) {
      Vec2d const p = vortex.position(start[n], (static_cast<double>(f) - 1) * factor[n]);
      bool const seen = to_unit(random()) >= lost && p.x > 0 && p.y > 0 && p.x < side && p.y < side;
      index[f].push_back(seen ? static_cast<int>(frames.places[f].size()) : -1);
      if (seen) frames.places[f].push_back(p + noise * Vec2d{normal_variate(random), normal_variate(random)});
    }
  for (std::size_t n = 0; n < count; ++n)
    if (index[1][n] >= 0) frames.partner.push_back(index[2][n]);
  for (std::vector<Vec2d>& places : frames.places)
    for (Vec2d const p : test::random_places(count / 10, side, 0, random)) places.push_back(p);
  frames.partner.resize(frames.places[1].size(), -1);
  for (Vec2d const p : frames.places[1]) {
    Vec2d sum;
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) {
        Vec2d const here = p + 4.0 * Vec2d{i - 3.5, j - 3.5};
        sum += vortex.position(here, 1) - here;
      }
    frames.prediction.push_back(sum / 64.0);
  }
  return frames;
}

/// Fractions of the particles with a partner; wrong matches of particles without a partner count as well.
struct Shares {
  double right = 0, wrong = 0, count = 0;
  void add(FourFrames const& frames, TrackNeighbours const& neighbours) {
    std::vector<DotMatch> const matches =
        match_dots(frames.places[1], frames.places[2], frames.prediction, {}, neighbours);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      count += frames.partner[i] >= 0 ? 1 : 0;
      if (matches[i].status != MatchStatus::matched) continue;
      (static_cast<int>(matches[i].partner) == frames.partner[i] ? right : wrong) += 1;
    }
  }
};

/// Shares of two, three (without the frame before) and four frames, over four realisations.
std::array<Shares, 3> measure_shares(Vortex const& vortex) {
  std::array<Shares, 3> shares;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    FourFrames const frames = make_frames(vortex, seed);
    shares[0].add(frames, {});
    shares[1].add(frames, {{}, frames.places[3]});
    shares[2].add(frames, {frames.places[0], frames.places[3]});
  }
  for (Shares& one : shares) {
    one.right /= one.count;
    one.wrong /= one.count;
  }
  return shares;
}

// Neighbours at other depths do not share a displacement, so that two frames lose the particles as the displacement
// grows. Four frames resolve those whose tracks are complete: with a tenth lost per frame, 0.81 of those with a
// partner.
TEST(TrackEvidence, FindsPartnersWhoseNeighboursMoveDifferently) {
  std::printf("  ratio   two: right  wrong   three: right  wrong   four: right  wrong\n");
  for (double const ratio : {0.2, 0.5, 1.0, 1.5, 2.0}) {
    auto const [two, three, four] = measure_shares({ratio * spacing});
    std::printf("%7.1f %12.3f %6.3f %14.3f %6.3f %13.3f %6.3f\n", ratio, two.right, two.wrong, three.right, three.wrong,
                four.right, four.wrong);
    EXPECT_GT(four.right, two.right + (ratio >= 1 ? 0.2 : -0.02)) << ratio;
    EXPECT_LT(four.wrong, 0.1) << ratio;
    EXPECT_GT(three.right, two.right - 0.02) << ratio;
  }
}

// If neighbours have the same displacement, they decide: a wrong candidate that is by chance part of a track has a
// support of about 0.1 + 0.4 (1 - 0.1) = 0.46. The right one has more, since 0.9 of its neighbours have a partner in
// frame B. Further frames therefore change at most two percent.
TEST(TrackEvidence, ChangesLittleInACoherentFlow) {
  for (double const ratio : {0.2, 1.0, 2.0}) {
    auto const [two, three, four] = measure_shares({ratio * spacing, 0});
    std::printf("coherent, ratio %.1f: right %.3f, %.3f, %.3f; wrong %.3f, %.3f, %.3f\n", ratio, two.right, three.right,
                four.right, two.wrong, three.wrong, four.wrong);
    for (Shares const& more : {three, four}) {
      EXPECT_NEAR(more.right, two.right, 0.02) << ratio;
      EXPECT_NEAR(more.wrong, two.wrong, 0.02) << ratio;
    }
  }
}

// For displacements of 1.5 spacings, two frames find the partners of 27 % of the particles and four frames those of 75
// % (see the table printed by FindsPartnersWhoseNeighboursMoveDifferently). Four frames thus find more than twice as
// many partners, from images as well.
TEST(TrackEvidence, ServesImagesOfASequence) {
  Vortex const vortex{1.5 * spacing};
  FourFrames const frames = make_frames(vortex, 1);
  KeyedEngine random(2, RandomStream::target, 0);
  std::array<Image<double>, 4> images;
  for (std::size_t f = 0; f < 4; ++f) {
    std::vector<test::SyntheticDot> dots;
    for (Vec2d const p : frames.places[f]) dots.push_back({p, 20000});
    images[f] = test::dot_image(static_cast<int>(side), dots, 2500, 200, random);
  }
  DisplacementField predictor;
  for (std::size_t i = 0; i < frames.prediction.size(); ++i) {
    predictor.position_px.push_back(frames.places[1][i]);
    predictor.displacement_px.push_back(frames.prediction[i]);
  }
  auto const count_right = [&](DisplacementField const& field) {
    int right = 0;
    for (std::size_t i = 0; i < field.size(); ++i)
      for (std::size_t k = 0; field.counts(i) && k < frames.partner.size(); ++k) {
        if (frames.partner[k] < 0) continue;
        Vec2d const a = frames.places[1][k], b = frames.places[2][static_cast<std::size_t>(frames.partner[k])];
        right += length(field.position_px[i] - 0.5 * (a + b)) < 0.5 && length(field.displacement_px[i] - (b - a)) < 0.5;
      }
    return right;
  };
  int const two = count_right(track_dots(images[1], images[2], predictor));
  TrackFrames const alone({images[1], images[2]}, std::nullopt, std::nullopt);
  LocatedFrames const located({}, 4);
  EXPECT_EQ(count_right(track_dots(alone, predictor, {}, located)), two);
  TrackFrames const sequence({images[1], images[2]}, images[0], images[3]);
  EXPECT_GT(count_right(track_dots(sequence, predictor, {}, located)), 2 * two);
}

// A frame is located once: the second call returns the same object, and with room for two frames the third frame
// replaces the one that was used first. A frame that differs by one grey level is another one.
TEST(LocatedFrames, RemembersTheLastFrames) {
  KeyedEngine random(3, RandomStream::target, 0);
  Image<double> const first = test::dot_image(32, {{{12.3, 15.8}, 20000}}, 2500, 200, random);
  Image<double> second = first, third = first;
  second(5, 5) += 1;
  third(6, 6) += 1;
  LocatedFrames const located({}, 2);
  auto const locate = [&](Image<double> const* a, Image<double> const* b) {
    return located.locate(std::array<Image<double> const*, 2>{a, b});
  };
  auto const once = locate(&first, &second), again = locate(&second, &first);
  EXPECT_EQ(once[0], again[1]);
  EXPECT_EQ(once[1], again[0]);
  EXPECT_NE(once[0], once[1]);
  ASSERT_EQ(once[0]->dots.size(), 1u);
  EXPECT_NEAR(once[0]->dots[0].image.centre.x, 12.3, 0.1);
  EXPECT_EQ(locate(&third, nullptr)[1], nullptr);
  EXPECT_EQ(locate(&first, nullptr)[0], once[0]);
  EXPECT_NE(locate(&second, nullptr)[0], once[1]);
}

}  // namespace
}  // namespace gladstone::inline tracking
