#pragma once

#include <cstddef>

#include "analysis/stereo/reconstruct.h"

namespace gladstone::stereo {

/// Sets the status of vectors to invalid if the two cameras disagree: the residual of the four equations, which have
/// one degree of freedom, exceeds `limit` of its standard uncertainties.
/// - Where the vectors have no uncertainty, that of the residual is estimated from all nodes: the median of a normal
///   distribution's absolute value is 0.6745 standard deviations.
/// - Residuals below 0.1 px are accepted, the usual fluctuation of correlated vectors (Westerweel & Scarano, Exp.
/// Fluids
///   39 (2005) 1096).
/// The residual contains only the difference between the cameras perpendicular to the plane of their lines of sight: an
/// error of one camera within that plane changes u and w but not the residual.
/// @param limit  of the residual, in standard uncertainties [1]; 0: accept all vectors
StereoField reject_large_residuals(StereoField field, double limit);

/// Returns the number of nodes whose vector is invalid.
std::size_t count_rejected(StereoField const& field);

}  // namespace gladstone::stereo
