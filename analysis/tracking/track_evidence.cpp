#include "analysis/tracking/track_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gladstone::inline tracking {

TrackEvidence::TrackEvidence(TrackNeighbours const& neighbours, double velocity_change_px, double tolerance_px)
    : neighbours_(neighbours),
      before_(neighbours.before),
      after_(neighbours.after),
      velocity_change_(velocity_change_px),
      tolerance_(tolerance_px) {}

double TrackEvidence::evaluate(Vec2d place, Vec2d displacement) const {
  double const e = misfit(place, displacement) / tolerance_;
  return std::isfinite(e) ? std::exp(-0.5 * e * e) : 0.0;
}

/// Returns the distance of the extrapolation from the nearest particle [px]; infinite if the distance exceeds three
/// tolerances.
double TrackEvidence::misfit(Vec2d place, Vec2d displacement) const {
  double least = std::numeric_limits<double>::infinity();
  double const farthest = 3 * tolerance_;
  bool const follows = !neighbours_.before.empty(), continues = !neighbours_.after.empty();
  if (!continues) return follows ? before_.distance(place - displacement, farthest) : least;
  if (!follows) return after_.distance(place + 2 * displacement, farthest);
  for (std::size_t const k : before_.within(place - displacement, velocity_change_)) {
    Vec2d const acceleration = displacement - (place - neighbours_.before[k]);
    least = std::min(least, after_.distance(place + 2 * displacement + acceleration, farthest));
  }
  return least;
}

}  // namespace gladstone::inline tracking
