#pragma once

#include <span>

#include "analysis/tracking/nearest_points.h"

namespace gladstone::inline tracking {

/// Centres of the particles in the frame before frame A and in the frame after frame B of a sequence with equal
/// intervals of time [px]; empty: no such frame.
struct TrackNeighbours {
  std::span<Vec2d const> before{}, after{};
};

/// Evidence that a displacement from frame A to frame B is part of a track through the neighbouring frames.
///
/// Four-frame best estimate (Ouellette, Xu & Bodenschatz, Exp. Fluids 40 (2006) 301; Cierpka, Luetke & Kaehler, Exp.
/// Fluids 54 (2013) 1533): the positions of a particle before the pair, in A and in B determine its velocity and
/// acceleration. The evidence is the stronger, the closer the extrapolated position is to a particle of the frame after
/// the pair. The source continues established tracks; here, every particle of the frame before the pair is a possible
/// history if the acceleration is small enough. The result thus depends on four frames only. If there is only one
/// neighbouring frame, only the velocity is extrapolated.
class TrackEvidence {
 public:
  /// @param neighbours  particles of the neighbouring frames; must outlive this object
  /// @param velocity_change_px  largest change of the displacement from one interval to the next [px]
  /// @param tolerance_px        standard deviation of the extrapolation [px]
  TrackEvidence(TrackNeighbours const& neighbours, double velocity_change_px, double tolerance_px);

  /// Returns exp(-e^2 / (2 tolerance^2)), where e is the distance of the extrapolation from the nearest particle, for
  /// the best history; 0 beyond three tolerances or without neighbours.
  /// @param place  position of the particle in frame A [px]
  /// @param displacement  displacement from frame A to frame B [px]
  double evaluate(Vec2d place, Vec2d displacement) const;

 private:
  double misfit(Vec2d place, Vec2d displacement) const;

  TrackNeighbours neighbours_;
  NearestPoints before_, after_;
  double velocity_change_, tolerance_;
};

}  // namespace gladstone::inline tracking
