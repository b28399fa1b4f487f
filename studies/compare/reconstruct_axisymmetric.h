#pragma once

#include <array>

#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Inverts the projected gradient of an axisymmetric flow, and mirrors the radial density about the axis into the axes
/// of the image. Sets grid, density, sigma_random, gradient, region, reference and axisymmetry; adds a warning if the
/// flow extends beyond the vectors, or is not symmetric.
/// @param result      reconstruction whose overlap and reference_density are set
/// @param projected   result of density::compute_projected_gradient() [kg/m^3]
/// @param axis_range  borders of the image across the axis, in the mid-plane [m]
/// @param options     options whose `axis` is set
/// @throws SetupError, DataError  as density::invert_axisymmetric()
Reconstruction invert_flow(Reconstruction result, density::GradientMap const& projected,
                           std::array<double, 2> axis_range, ReconstructOptions const& options);

}  // namespace gladstone::inline compare
