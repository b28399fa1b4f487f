#include "analysis/correlation/methods/rpc.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "analysis/correlation/correlation_methods.h"
#include "render/base/units.h"

namespace gladstone::inline correlation {

std::vector<float> particle_spectrum(int size) {
  std::vector<double> factor;
  for (int k = 0; k < size; ++k) {
    double const wave = 2.0 * pi * (k < size / 2 ? k : k - size) / size;
    factor.push_back(std::exp(-wave * wave * robust_phase_diameter_px * robust_phase_diameter_px / 16.0));
  }
  double const all = std::accumulate(factor.begin(), factor.end(), 0.0);
  std::vector<float> share;
  for (double const f : factor) share.push_back(static_cast<float>(f / all));
  return share;
}

void make_robust_phase_plane(LaneCorrelation& work, LanePlane& plane) {
  work.load(WindowTerm::frames);
  FloatLanes const scale = work.windows().scale(work.size());
  std::vector<float> const factor = particle_spectrum(work.size());
  work.correlate(
      scale,
      [&](ComplexLanes* spectrum, int kx, int size) {
        float const along_x = factor[static_cast<std::size_t>(kx)];
        // The windows have zero mean, so that the value at wave number 0 is rounding error.
        if (kx == 0) spectrum[0] = {FloatLanes{}, FloatLanes{}};
        for (int ky = 0; ky < size; ++ky) {
          ComplexLanes& c = spectrum[ky];
          FloatLanes const magnitude = root_lanes(c.re * c.re + c.im * c.im) + 1e-30f;
          FloatLanes const to = along_x * factor[static_cast<std::size_t>(ky)] / magnitude;
          c = {to * c.re, to * c.im};
        }
      },
      plane);
}

std::vector<WindowCorrelation> correlate_rpc(InterrogationJob const& job) {
  return correlate_in_lanes(job, {make_robust_phase_plane});
}

}  // namespace gladstone::inline correlation
