#pragma once

#include <string>
#include <vector>

#include "render/base/image.h"
#include "studies/figures/map_panels.h"

namespace gladstone {

/// Displacement maps of one source, both components [px].
struct NamedMaps {
  std::string name;  ///< "ray truth", "Eq. 9", "cone-filtered Eq. 9", "measurement"
  Image<double> u_px;
  Image<double> v_px;
};

/// A column per source with u above v, on the range of the first source (larger values take the end colours), then the
/// differences from the first, on one range a source.
/// @param sources the first is what the others are compared with; maps of one size
void write_displacement_maps(std::string const& path, std::string const& title, MapAxes const& axes,
                             std::vector<NamedMaps> const& sources);

/// One instant of the seed's Figure 4; maps of one size, row 0 at the top of the picture.
struct SeedFigure4Instant {
  std::string heading;                   ///< "t = 2.56, after the peak of kinetic energy"
  Image<double> density;                 ///< [kg/m^3]
  Image<double> gradient_x, gradient_y;  ///< d rho/dx, d rho/dy, y upwards [kg/m^4]
  NamedMaps theory;                      ///< Eq. 9
  NamedMaps cone;                        ///< Eq. 9 averaged over the cone, interpolated as the rays are
  NamedMaps rays;                        ///< ray displacement interpolated onto the grid
};

/// Rajendran, Bane & Vlachos, Figure 4: contours of density, density gradients, theoretical displacements, simulated
/// light ray displacements, and between these Eq. 9 averaged over the ray cone; two rows an instant, whose
/// displacements share one range, as its gradients do. The magnitude of the gradient fills the place below the density.
void write_seed_figure4(std::string const& path, MapAxes const& axes, std::vector<SeedFigure4Instant> const& instants);

}  // namespace gladstone
