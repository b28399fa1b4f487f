#pragma once

#include <string>

#include "render/base/displacement_field.h"
#include "render/base/image.h"

namespace gladstone {

/// Density, averaged over the thickness, less the ambient one, at the vectors of a lattice [kg/m^3]: the least-squares
/// solution of rho(j) - rho(i) = h (g(i) + g(j)) / 2 between neighbours, exact for quadratic fields; its mean along the
/// border is 0. Where vectors are not known the differences are taken for small.
/// @param gradient d rho / d(X, Y) at the vectors, X right and Y up, row by row downwards; NaN: not known [kg/m^4]
/// @param spacing  of the vectors in the medium [m]
/// @pre columns and rows of 2 or more
Image<double> integrated_density(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing);

/// Writes it as a NRRD plane, y upwards, continued straight over `margin` nodes beyond its border, on top of `ambient`.
/// @throws OutputError
void write_density_plane(std::string const& path, Image<double> const& density, int margin, double ambient);

}  // namespace gladstone
