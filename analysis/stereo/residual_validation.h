#pragma once

#include <cstddef>

#include "analysis/stereo/reconstruct.h"

namespace gladstone::inline stereo {

/// Sets the status of vectors to invalid if the two cameras disagree: a vector is invalid if the residual of the four
/// equations, which have one degree of freedom, exceeds `limit` times the standard uncertainty of this residual.
/// - If the vectors have no uncertainty, the standard deviation of the residual is estimated from its median over all
///   nodes: the median magnitude of normally distributed values is 0.6745 standard deviations.
/// - Residuals below 0.1 px are accepted, the usual fluctuation of correlated vectors (Westerweel & Scarano, Exp.
/// Fluids
///   39 (2005) 1096).
/// The residual contains only that part of the difference between the cameras which is perpendicular to the plane of
/// their lines of sight. An error of one camera within this plane changes u and w but not the residual.
/// @param limit  largest residual, in standard uncertainties [1]; 0: accept all vectors
StereoField reject_large_residuals(StereoField field, double limit);

/// Returns the number of nodes whose vector is invalid.
std::size_t count_rejected(StereoField const& field);

}  // namespace gladstone::inline stereo
