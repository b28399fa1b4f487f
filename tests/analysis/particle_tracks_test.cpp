#include "analysis/tracking/particle_tracks.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/analysis/synthetic_dots.h"

namespace gladstone::tracking {
namespace {

constexpr double extent = 400, omega = 0.05;

/// Particles in solid-body rotation about the centre, by `omega` per frame, plus noise of 0.05 px; particle k has index
/// k in every frame.
std::vector<std::vector<Vec2d>> rotating_frames(std::size_t count, std::size_t frames) {
  KeyedEngine random(4, RandomStream::particles, 0);
  std::vector<Vec2d> const places = test::random_places(count, extent, 0, random);
  std::vector<std::vector<Vec2d>> sequence(frames);
  for (std::size_t n = 0; n < frames; ++n)
    for (Vec2d const p : places) {
      double const x = p.x - extent / 2, y = p.y - extent / 2, c = std::cos(omega * static_cast<double>(n));
      double const s = std::sin(omega * static_cast<double>(n));
      sequence[n].push_back(Vec2d{extent / 2 + c * x - s * y, extent / 2 + s * x + c * y} +
                            0.05 * Vec2d{normal_variate(random), normal_variate(random)});
    }
  return sequence;
}

/// Links between consecutive places of a track.
struct Links {
  double right = 0;  ///< fraction of the links of all tracks that connect the same particle
  double found = 0;  ///< fraction of all possible links that are right and in a track
};

Links measure_links(std::vector<Track> const& tracks, std::size_t count, std::size_t frames) {
  double links = 0, right = 0;
  for (Track const& track : tracks)
    for (std::size_t k = 1; k < track.length(); ++k) {
      ++links;
      right += track.particles[k] == track.particles[k - 1] ? 1 : 0;
    }
  return {right / links, right / static_cast<double>(count * (frames - 1))};
}

// Displacements are up to 14 px, and the spacing decreases from 20 to 8 px. The prediction by the flow field has an
// error of 10 %; it is required for the first step of each track only.
TEST(ParticleTracks, FollowParticlesThroughARotation) {
  auto const predict = [](Vec2d p) { return 0.9 * omega * Vec2d{-(p.y - extent / 2), p.x - extent / 2}; };
  std::printf("   spacing   displacement/spacing   right links   found links\n");
  for (double const spacing : {20.0, 12.0, 8.0}) {
    auto const count = static_cast<std::size_t>(extent * extent / (spacing * spacing));
    auto const frames = rotating_frames(count, 8);
    TrackSettings settings;
    settings.search_radius_px = 2;
    settings.start_radius_px = 3;
    Links const links = measure_links(track_particles(frames, predict, settings), count, 8);
    std::printf("%8.1f %14.2f %20.4f %12.4f\n", spacing, 0.38 * omega * extent / spacing, links.right, links.found);
    EXPECT_GT(links.right, 0.98) << spacing;
    EXPECT_GT(links.found, 0.96) << spacing;
  }
}

TEST(ParticleTracks, StartAndEndWithTheirParticles) {
  std::vector<std::vector<Vec2d>> const frames{{{0, 0}},   {{1, 0}, {50, 50}}, {{2, 0}, {50, 51}},
                                               {{50, 52}}, {{50, 53}},         {}};
  TrackSettings settings;
  settings.search_radius_px = 2;
  auto const tracks = track_particles(frames, nullptr, settings);
  ASSERT_EQ(tracks.size(), 2u);
  EXPECT_EQ(tracks[0].first_frame, 0u);
  EXPECT_EQ(tracks[0].length(), 3u);
  EXPECT_EQ(tracks[1].first_frame, 1u);
  EXPECT_EQ(tracks[1].particles, (std::vector<std::size_t>{1, 1, 0, 0}));
  DisplacementField const vectors = track_vectors(tracks, frames, {}, 1);
  ASSERT_EQ(vectors.size(), 2u);
  EXPECT_EQ(vectors.position_px[0], (Vec2d{1.5, 0}));
  EXPECT_EQ(vectors.displacement_px[1], (Vec2d{0, 1}));
  EXPECT_TRUE(track_particles({}, nullptr).empty());
}

// The four-frame estimate selects the particle whose extended path meets a particle in the next frame, although another
// one is closer to the predicted place.
TEST(ParticleTracks, TheFrameAfterTheNextDecides) {
  std::vector<std::vector<Vec2d>> const frames{{{0, 0}}, {{5, 0}}, {{10, 0.8}, {10, -0.4}}, {{15, 2.4}}};
  TrackSettings settings;
  settings.search_radius_px = 2;
  auto const tracks = track_particles(
      frames,
      [](Vec2d) {
        return Vec2d{5, 0};
      },
      settings);
  ASSERT_EQ(tracks.size(), 1u);
  EXPECT_EQ(tracks[0].particles, (std::vector<std::size_t>{0, 0, 0, 0}));
}

}  // namespace
}  // namespace gladstone::tracking
