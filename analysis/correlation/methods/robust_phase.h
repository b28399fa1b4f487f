#pragma once

#include <vector>

#include "analysis/correlation/lane_correlation.h"

namespace gladstone {

/// e^-2 diameter of the particle images whose spectrum weighs the phases [px]; the choice of Eckstein & Vlachos (2009).
constexpr double robust_phase_diameter_px = 2.8;

/// exp(-k^2 d^2/16) along one axis, `size` wave numbers, their sum 1: the spectrum of the correlation of two Gaussian
/// images of that diameter.
std::vector<float> particle_spectrum(int size);

/// The plane of rpc: a peak of Gaussian shape with the variance diameter^2/8 where phases agree, its height 1 at most.
void make_robust_phase_plane(LaneCorrelation& work, LanePlane& plane);

}  // namespace gladstone
