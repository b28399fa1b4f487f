#pragma once

#include <span>
#include <vector>

#include "analysis/tracking/dot_location.h"
#include "analysis/tracking/dot_matching.h"

namespace gladstone::inline tracking {

/// Estimates the standard uncertainty of the displacement of each dot between two frames [px].
///
/// The misfit of a dot image to the model is much the same in both frames, so that its effects on the two centres
/// cancel in the displacement; the even part of the misfit does not shift the centres. The noise, and the variation of
/// the misfit with the position of the dot relative to the pixels, remain in the odd part of the difference of the
/// residuals of both frames, registered to whole pixels. The variances of both fits are therefore scaled by the ratio
/// of the mean square of this odd part to that of the noise, instead of by the reduced chi2 of each fit. Since a dot
/// has few pixels, the mean square is averaged with the median of all dots, which has the weight of 20 pixels.
/// @param matches  one match per dot of a
/// @return standard uncertainty of each dot of a; NaN for dots without a partner
std::vector<Vec2d> displacement_sigmas(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches);

}  // namespace gladstone::inline tracking
