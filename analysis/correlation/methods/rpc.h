#pragma once

#include <vector>

#include "analysis/correlation/lane_correlation.h"

namespace gladstone::inline correlation {

/// e^-2 diameter of the particle images whose spectrum weights the phases [px]; value of Eckstein & Vlachos (2009).
constexpr double robust_phase_diameter_px = 2.8;

/// Returns exp(-k^2 d^2/16) along one axis for `size` wave numbers, normalised to a sum of 1: the spectrum of the
/// correlation of two Gaussian particle images of diameter d.
std::vector<float> particle_spectrum(int size);

/// Computes the plane of method "rpc". If all phases agree, the plane is a Gaussian peak of height 1 with a variance of
/// diameter^2/8.
void make_robust_phase_plane(LaneCorrelation& work, LanePlane& plane);

}  // namespace gladstone::inline correlation
