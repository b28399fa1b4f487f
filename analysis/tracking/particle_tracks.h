#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::tracking {

/// Particle followed through consecutive frames.
struct Track {
  std::size_t first_frame = 0;
  std::vector<std::size_t> particles;  ///< index of the particle in each frame, from first_frame on

  std::size_t length() const { return particles.size(); }
};

/// Settings of track_particles().
struct TrackSettings {
  /// Largest distance from the predicted place of a particle with at least two earlier places [px]; 0: half the mean
  /// spacing of the particles.
  double search_radius_px = 0;
  double start_radius_px = 0;      ///< the same for particles with one earlier place [px]; 0: search_radius_px
  std::size_t shortest_track = 3;  ///< smallest number of frames of a track
};

/// Prediction of the displacement to the next frame [px] at a place [px].
using DisplacementPrediction = std::function<Vec2d(Vec2d)>;

/// Follows particles through a sequence by the four-frame best estimate (Malik, Dracos & Papantoniou, Exp. Fluids 15
/// (1993) 279; Ouellette, Xu & Bodenschatz, Exp. Fluids 40 (2006) 301).
///
/// A particle with places in frames n - 1 and n is predicted in frame n + 1 with constant velocity; each particle there
/// within the search radius is extended to frame n + 2 with constant acceleration. The candidate whose extension is
/// closest to a particle of frame n + 2 continues the track. A particle without an earlier place is predicted by the
/// given displacement, and extended with constant velocity. In the last frame the distance from the prediction decides.
/// If several tracks could continue with the same particle, established tracks have priority over starting ones, then
/// the track with the smallest distance.
/// @param frames   places of the particles in each frame [px]; those that are not finite are ignored
/// @param predict  displacement of particles without an earlier place, for example of a correlation; null: zero
/// @return tracks of at least settings.shortest_track frames, by first frame and particle; each particle is in at most
///         one track. Independent of the number of threads.
/// @throws Interrupted
std::vector<Track> track_particles(std::span<std::vector<Vec2d> const> frames, DisplacementPrediction const& predict,
                                   TrackSettings const& settings = {});

/// Returns the displacements of all tracked particles from a frame to the next one, at the mid-positions.
/// @param sigmas  standard uncertainty of the places in each frame [px]; empty: unknown
/// @pre frame + 1 < frames.size(); sigmas are empty or of the sizes of frames
DisplacementField track_vectors(std::span<Track const> tracks, std::span<std::vector<Vec2d> const> frames,
                                std::span<std::vector<Vec2d> const> sigmas, std::size_t frame);

}  // namespace gladstone::tracking
