#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/lane_correlation.h"

namespace gladstone::inline correlation {

std::vector<WindowCorrelation> correlate_scc(InterrogationJob const& job) {
  return correlate_in_lanes(job, {[](LaneCorrelation& work, LanePlane& plane) {
                              work.load(WindowTerm::frames);
                              work.correlate(work.windows().scale(work.size()), {}, plane);
                            }});
}

}  // namespace gladstone::inline correlation
