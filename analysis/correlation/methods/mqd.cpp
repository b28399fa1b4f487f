#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/lane_correlation.h"

namespace gladstone::inline correlation {
namespace {

void make_difference_plane(LaneCorrelation& work, LanePlane& plane) {
  LanePlane back = plane, flow = plane, reference = plane;
  work.load(WindowTerm::search);
  float const values = static_cast<float>(work.size()) * static_cast<float>(work.size());
  FloatLanes const known = work.windows().scale(work.size());
  FloatLanes const both = work.windows().energy_reference() + work.windows().energy_flow();
  FloatLanes const scale =
      select_lanes(known > 0.0f, 1.0f / (larger_lanes(both, all_lanes(1e-30f)) * values), FloatLanes{});
  work.correlate(scale, {}, plane);
  work.load(WindowTerm::search_back);
  work.correlate(scale, {}, back);
  work.load(WindowTerm::search_energy);
  work.correlate(scale, {}, flow);
  work.load(WindowTerm::search_back_energy);
  work.correlate(scale, {}, reference);
  for (int dy = -plane.reach(); dy <= plane.reach(); ++dy)
    for (int dx = -plane.reach(); dx <= plane.reach(); ++dx)
      plane(dx, dy) = 2.0f * (plane(dx, dy) + back(dx, dy)) /
                      (1.0f + larger_lanes(flow(dx, dy), FloatLanes{}) + larger_lanes(reference(dx, dy), FloatLanes{}));
}

}  // namespace

std::vector<WindowCorrelation> correlate_mqd(InterrogationJob const& job) {
  return correlate_in_lanes(job, {.make = make_difference_plane, .with_margin = true, .decreases_with_shift = false});
}

}  // namespace gladstone::inline correlation
