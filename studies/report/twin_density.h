#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline report {

/// Integrates measured gradients to the density of a simulated twin, which requires a value at every node and no
/// reference region. The largest connected region of vectors is integrated with equal weights
/// (density::DensityIntegrator), exact for quadratic fields; harmonic functions continue it to the other nodes
/// (density::HarmonicContinuation). The constant is chosen such that the mean along the border of the lattice is zero.
/// @param gradient  d rho / d(X, Y) at the vectors, X right and Y up, row by row downwards; NaN: unknown [kg/m^4]
/// @param spacing   distance between vectors in the medium [m]
/// @return          density minus ambient density, averaged over the thickness [kg/m^3], rows downwards
/// @throws DataError if no gradient is known
/// @pre at least 2 columns and 2 rows
Image<double> compute_twin_density(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing);

}  // namespace gladstone::inline report
