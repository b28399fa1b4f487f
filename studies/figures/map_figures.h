#pragma once

#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "render/base/image.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {

/// Displacement maps of one source, both components [px].
struct NamedMaps {
  std::string name;  ///< "ray truth", "Eq. 9", "aperture-averaged Eq. 9", "measurement"
  Image<double> u_px;
  Image<double> v_px;
};

/// Returns the coordinates of vectors on a lattice.
/// @pre field.columns and rows exceed 1
MapAxes lattice_axes(DisplacementField const& field);

/// Returns a component of values at the vectors of a lattice as a map.
Image<double> component_map(DisplacementField const& lattice, std::vector<Vec2d> const& values, double Vec2d::*part);

/// Magnitude and both components of values at the vectors of a lattice, side by side.
Figure make_vector_maps(DisplacementField const& lattice, std::vector<Vec2d> const& values, std::string const& unit);

/// One column per source with u above v, with the colour range of the first source (larger values are clipped),
/// then the differences from the first source, with one range per source.
/// @param sources  maps of equal size; the first is the reference
Figure make_displacement_maps(std::string const& title, MapAxes const& axes, std::vector<NamedMaps> const& sources);

/// One instant of Figure 4 of Rajendran et al. (2019); maps of equal size, row 0 at the top.
struct SeedFigure4Instant {
  std::string heading;                   ///< e.g. "t = 2.56, after the peak of kinetic energy"
  Image<double> density;                 ///< [kg/m^3]
  Image<double> gradient_x, gradient_y;  ///< d rho/dx, d rho/dy, y upwards [kg/m^4]
  NamedMaps theory;                      ///< small-angle theory (Eq. 9)
  NamedMaps cone;                        ///< aperture-averaged theory, interpolated like the rays
  NamedMaps rays;                        ///< ray displacements interpolated onto the grid
};

/// Figure 4 of Rajendran, Bane & Vlachos (2019): maps of density, density gradient, theoretical and ray
/// displacement, and additionally the aperture-averaged theory. Each instant has two rows; its displacements share one
/// colour range, as do its gradients. The panel below the density shows the magnitude of the gradient.
Figure make_seed_figure4(MapAxes const& axes, std::vector<SeedFigure4Instant> const& instants);

}  // namespace gladstone::inline figures
