#pragma once

#include <complex>
#include <string>
#include <vector>

#include "render/light/mie.h"

namespace gladstone {

/// Light that a sphere scatters over angle, from forward to backward.
struct ScatteringDiagram {
  double x;
  std::complex<double> m;
  MieEfficiencies efficiencies;
  std::vector<double> angle_deg;
  std::vector<double> s1_squared;  ///< |S1|^2 [1]
  std::vector<double> s2_squared;  ///< |S2|^2 [1]
};

/// Draws |S1|^2 and |S2|^2 on polar paper whose radius is logarithmic, a circle a decade: the field across the plane of
/// scattering in the upper half, in the plane in the lower one; light comes from the left. What is below the innermost
/// circle's decade is drawn in the centre.
/// @throws GnuplotMissing, OutputError
void write_mie_figure(std::string const& path, ScatteringDiagram const& diagram);

}  // namespace gladstone
