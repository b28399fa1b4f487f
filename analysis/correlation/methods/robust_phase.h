#pragma once

#include "analysis/correlation/lane_correlation.h"

namespace gladstone {

/// e^-2 diameter of the particle images whose spectrum weighs the phases [px]; the choice of Eckstein & Vlachos (2009).
constexpr double robust_phase_diameter_px = 2.8;

/// The plane of rpc: a peak of Gaussian shape with the variance diameter^2/8 where phases agree, its height 1 at most.
void make_robust_phase_plane(LaneCorrelation& work, LanePlane& plane);

}  // namespace gladstone
