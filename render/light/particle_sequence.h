#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/light/particles.h"

namespace gladstone::inline light {

/// Particles of a sequence of frames at equal intervals flow.dt, each advected from frame to frame along the flow.
/// - The particles of the first frame fill the volume, as those of seed_particles() do. Particles that leave it are
/// dropped. Before every step, further particles are drawn around the volume, and those that enter it are added, so
/// that the number density remains that of the seeding.
/// - Particles of a file are not replaced. Without a volume all of them are retained.
/// - A particle depends on the seed, the frame in which it was drawn and its index only, so that a frame is the same in
/// both pairs to which it belongs, for any number of threads.
class ParticleSequence {
 public:
  /// @param count      mean number of particles in the volume; ignored for particles of a file
  /// @param flow       flow, with dt the time between frames
  /// @param tolerance  maximum change of a position after dt when the step is halved [m]
  /// @throws DataError for an invalid file of particles or diameters
  ParticleSequence(ParticleSetup setup, double count, FlowSetup flow, LaserSheet<double> const& sheet,
                   double tolerance);

  /// Returns the particles of frames `number` and `number` + 1 that receive light in at least one of them. Pairs in
  /// ascending order take one step each; a smaller number starts again from the first frame.
  Particles pair(std::size_t number);

  FlowSetup const& flow() const { return flow_; }

 private:
  /// Positions [m] and diameters [m] of particles.
  struct Places {
    std::vector<Vec3d> place;
    std::vector<double> diameter;
  };
  enum class Region { volume, surroundings };

  void start();
  /// Draws the particles of a frame inside the volume, or in the surroundings from which particles can reach the volume
  /// within dt.
  Places draw(std::size_t frame, Region region) const;
  /// Returns all particles of the current and the next frame, without their light.
  Particles move() const;
  /// Proceeds to the next frame. @param both  particles of the current and the next frame, from move()
  void advance(Particles const& both);

  ParticleSetup setup_;
  double count_;
  FlowSetup flow_;
  LaserSheet<double> sheet_;
  double tolerance_;
  std::size_t frame_ = 0;  ///< number of the current frame
  Places now_;             ///< particles in the volume at the current frame
  PathPlan path_;
};

/// Parts of a sequence of particles that its pairs share, filled when the first of them is built. Used by one thread at
/// a time.
struct ParticleCache {
  std::optional<ParticleSequence> sequence;
  Warnings flow_warnings;  ///< warnings from loading the flow
  double photon_unit = 0;  ///< brightest particle of the first pair [photons]; 0: not computed
};

}  // namespace gladstone::inline light
