#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/lane_correlation.h"

namespace gladstone::inline correlation {
namespace {

void make_normalised_plane(LaneCorrelation& work, LanePlane& plane) {
  LanePlane reference = plane, flow = plane;
  work.load(WindowTerm::frames);
  FloatLanes const scale = work.windows().scale(work.size());
  float const size = static_cast<float>(work.size());
  // Normalise both energies by the total that `scale` contains, so that their product is about 1 at shift 0.
  FloatLanes const energy = 1.0f / larger_lanes(scale * size * size, all_lanes(1e-30f));
  work.correlate(scale, {}, plane);
  FloatLanes const part = 1.0f / (energy * size * size);
  work.load(WindowTerm::reference_energy);
  work.correlate(part, {}, reference);
  work.load(WindowTerm::flow_energy);
  work.correlate(part, {}, flow);
  for (int dy = -plane.reach(); dy <= plane.reach(); ++dy)
    for (int dx = -plane.reach(); dx <= plane.reach(); ++dx) {
      // Rounding may make the energy of a dark corner of the window zero or negative.
      FloatLanes const least = all_lanes(1e-3f);
      plane(dx, dy) /= root_lanes(larger_lanes(reference(dx, dy), least) * larger_lanes(flow(dx, dy), least));
    }
}

}  // namespace

std::vector<WindowCorrelation> correlate_zncc(InterrogationJob const& job) {
  return correlate_in_lanes(job, {.make = make_normalised_plane, .decreases_with_shift = false});
}

}  // namespace gladstone::inline correlation
