#pragma once

#include "analysis/correlation/correlation_settings.h"

namespace gladstone::inline uncertainty {

/// Returns the ratio of a vector's random error after all passes to that of a single pass with the last windows; 1 for
/// a single pass and for optical flow.
/// Each pass measures the residual between frames deformed by the previous pass, including the noise of that pass. With
/// the response H_k(f) of the windows (Fourier transform of their squared weights) and P_k(f) of the predictor
/// (CorrelationSchedule::smoothing() and cubic convolution), the noise is filtered by A_0 = H_0, A_k = H_k + (1 - H_k)
/// P_(k-1) A_(k-1) (recursion of Schrijer & Scarano, Exp. Fluids 45 (2008) 927, with windows that differ between
/// passes). For white noise, the square of the ratio is integral |A|^2 over integral |H|^2 of the last pass. Aliasing
/// at the predictor's nodes is neglected.
double amplification_of_passes(CorrelationSettings const& settings);

}  // namespace gladstone::inline uncertainty
