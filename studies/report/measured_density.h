#pragma once

#include <string>

#include "analysis/vectors/displacement_field.h"
#include "render/base/image.h"

namespace gladstone {

/// Integrates gradients on a lattice to the density, averaged over the thickness, minus the ambient density [kg/m^3].
/// Least-squares solution of rho(j) - rho(i) = h (g(i) + g(j)) / 2 between neighbours, exact for quadratic fields, with
/// zero mean along the border. Across unknown vectors, small differences are preferred.
/// @param gradient  d rho / d(X, Y) at the vectors, X right and Y up, row by row downwards; NaN: unknown [kg/m^4]
/// @param spacing   distance between vectors in the medium [m]
/// @pre at least 2 columns and 2 rows
Image<double> integrated_density(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing);

/// Writes density plus `ambient` as a NRRD plane, y upwards, linearly extrapolated by `margin` nodes beyond its border.
/// @throws OutputError if the file cannot be written
void write_density_plane(std::string const& path, Image<double> const& density, int margin, double ambient);

}  // namespace gladstone
