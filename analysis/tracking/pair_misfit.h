#pragma once

#include <cstddef>

#include "analysis/tracking/dot_location.h"

namespace gladstone::tracking {

/// Estimates the standard uncertainty of the displacement of a dot between two frames [px].
///
/// The misfit of a dot image to the Gaussian is much the same in both frames, so that its effects on the two centres
/// cancel in the displacement. Noise, and the change of the misfit with the pixel phase, do not: they are the
/// difference of the residuals of both frames, registered to whole pixels. The variances of both fits are therefore
/// scaled by the mean square of this difference over that of the noise, instead of by the reduced chi2 of each fit.
/// @param i, k  index of the dot in frames A and B
Vec2d displacement_sigma(LocatedDots const& a, LocatedDots const& b, std::size_t i, std::size_t k);

}  // namespace gladstone::tracking
