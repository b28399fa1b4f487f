#pragma once

#include <vector>

#include "analysis/density/projected_gradient.h"
#include "analysis/density/regions.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Warns of regions whose density is undetermined because they contain no reference node.
void warn_of_regions(Reconstruction& result, std::vector<density::Region> const& regions);

/// Warns of a reference region that contains all vectors, or in which the density is not uniform: its mean gradient, in
/// which noise averages out, is compared with the rms gradient of all nodes.
void warn_of_reference_gradient(Reconstruction& result);

/// Change of a density by the averaging over the interrogation windows.
struct WindowEffect {
  double change = 0.0;  ///< rms change, estimated [kg/m^3]
  double sigma = 0.0;   ///< rms standard uncertainty of the nodes for which `change` is estimated [kg/m^3]
};

/// Estimates the change of a density by the mean over windows of w_x x w_y, (w_x^2 d2/dx2 + w_y^2 d2/dy2) / 24 of the
/// density. Its derivatives are differences over steps of about w / 2 of the measured density, which the windows have
/// smoothed already; on the other hand, passes that deform the frames recover a part of the change.
/// @return zero if no node with an uncertainty has neighbours at these steps
WindowEffect estimate_window_effect(Reconstruction const& result);

/// Warns if the averaging over the windows, which sigma does not contain, is larger than sigma.
void warn_of_window(Reconstruction& result);

/// Computes the rms gradient of the displacement [px/px], without the part that is due to noise. The displacement is
/// the gradient of a potential, so that the mean of |grad u|^2 over the field equals that of div(u)^2 - curl(u)^2, in
/// which the noise of u and v cancels.
double compute_displacement_gradient(density::GradientMap const& projected, density::ProjectionOptics const& optics);

/// Warns of displacement gradients that are so large that Eq. 9 has noticeable errors. Eq. 9 evaluates the density
/// gradient where undeflected rays meet the medium, while a deflection e displaces this point by e Z_A Z_D / (Z_A +
/// Z_D).
void warn_of_displacement_gradient(Reconstruction& result, density::GradientMap const& projected,
                                   density::ProjectionOptics const& optics);

}  // namespace gladstone::inline compare
