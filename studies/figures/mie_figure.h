#pragma once

#include <complex>
#include <vector>

#include "render/light/mie.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Light scattered by a sphere against the scattering angle, from forward to backward.
struct ScatteringDiagram {
  double x;
  std::complex<double> m;
  MieEfficiencies efficiencies;
  std::vector<double> angle_deg;
  std::vector<double> s1_squared;  ///< |S1|^2 [1]
  std::vector<double> s2_squared;  ///< |S2|^2 [1]
};

/// |S1|^2 and |S2|^2 in a polar diagram with logarithmic radius, one circle per decade. The upper half shows the
/// field perpendicular to the scattering plane, the lower half the field in the plane; light comes from the left.
/// Values below the innermost decade are drawn at the centre.
Figure make_mie_figure(ScatteringDiagram const& diagram);

}  // namespace gladstone::inline figures
