#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/lane_correlation.h"

namespace gladstone::inline correlation {
namespace {

void make_filtered_plane(LaneCorrelation& work, LanePlane& plane) {
  work.load(WindowTerm::frames);
  FloatLanes const scale = work.windows().scale(work.size());
  FloatLanes whole{};  // height that the plane would have if all phases agreed
  work.correlate(
      scale,
      [&](ComplexLanes* spectrum, int kx, int size) {
        // columns between the first and the last one count twice, since the other half of the spectrum mirrors them
        float const times = kx == 0 || kx == size / 2 ? 1.0f : 2.0f;
        for (int ky = 0; ky < size; ++ky) {
          ComplexLanes& c = spectrum[ky];
          FloatLanes const root = root_lanes(root_lanes(c.re * c.re + c.im * c.im)) + 1e-30f;
          whole += times * root;
          c = {c.re / root, c.im / root};
        }
      },
      plane);
  FloatLanes const to = 1.0f / larger_lanes(whole, all_lanes(1e-20f));
  for (int dy = -plane.reach(); dy <= plane.reach(); ++dy)
    for (int dx = -plane.reach(); dx <= plane.reach(); ++dx) plane(dx, dy) *= to;
}

}  // namespace

std::vector<WindowCorrelation> correlate_spc(InterrogationJob const& job) {
  return correlate_in_lanes(job, {make_filtered_plane});
}

}  // namespace gladstone::inline correlation
