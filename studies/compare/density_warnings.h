#pragma once

#include <vector>

#include "analysis/density/projected_gradient.h"
#include "analysis/density/regions.h"
#include "studies/compare/reconstruct.h"

namespace gladstone {

/// Warns of regions whose density is undetermined because they contain no reference node.
void warn_of_regions(Reconstruction& result, std::vector<density::Region> const& regions);

/// Warns of a reference region that contains all vectors, or in which the density is not uniform: its mean gradient, in
/// which noise averages out, is compared with the rms gradient of all nodes.
void warn_of_reference_gradient(Reconstruction& result);

/// Computes the rms gradient of the displacement [px/px], without the part that is due to noise. The displacement is
/// the gradient of a potential: |grad u|^2 is div(u)^2 less curl(u)^2 on average over the field, and in these the noise
/// of u and v cancels.
double compute_displacement_gradient(density::GradientMap const& projected, density::ProjectionOptics const& optics);

/// Warns of displacement gradients from which on Eq. 9 has noticeable errors: it evaluates the density gradient where
/// rays would meet the medium without deflection, while a deflection e moves this place by e Z_A Z_D / (Z_A + Z_D).
void warn_of_displacement_gradient(Reconstruction& result, density::GradientMap const& projected,
                                   density::ProjectionOptics const& optics);

}  // namespace gladstone
