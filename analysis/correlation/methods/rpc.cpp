#include <cmath>
#include <vector>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/methods/robust_phase.h"
#include "render/base/units.h"

namespace gladstone {
namespace {

/// exp(-k^2 d^2/16) along one axis: the spectrum of the correlation of two Gaussian images of e^-2 diameter d.
std::vector<float> particle_spectrum(int size) {
  std::vector<float> factor(static_cast<std::size_t>(size));
  for (int k = 0; k < size; ++k) {
    double const wave = 2.0 * pi * (k < size / 2 ? k : k - size) / size;
    factor[static_cast<std::size_t>(k)] =
        static_cast<float>(std::exp(-wave * wave * robust_phase_diameter_px * robust_phase_diameter_px / 16.0));
  }
  return factor;
}

}  // namespace

void make_robust_phase_plane(LaneCorrelation& work, LanePlane& plane) {
  work.load(WindowTerm::frames);
  FloatLanes const scale = work.windows().scale(work.size());
  std::vector<float> const factor = particle_spectrum(work.size());
  float all = 0.0f;
  for (float const f : factor) all += f;
  work.correlate(
      scale,
      [&](ComplexLanes* spectrum, int kx, int size) {
        float const along_x = factor[static_cast<std::size_t>(kx)] / (all * all);
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

}  // namespace gladstone
