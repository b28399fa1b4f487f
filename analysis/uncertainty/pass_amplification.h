#pragma once

#include "analysis/correlation/correlation_settings.h"

namespace gladstone {

/// How many times larger the random error of a vector is after all passes than that of the last windows alone. A pass
/// measures what is left of frames that the pass before deformed, noise of dots included: with the windows' response
/// H_k(f), the Fourier transform of their squared weights, and the predictor's P_k(f), that of its smoothing
/// (CorrelationSchedule::smoothing()) and its cubic convolution between nodes, the noise of dots comes out filtered by
/// A_0 = H_0, A_k = H_k + (1 - H_k) P_(k-1) A_(k-1) (the recursion of Schrijer & Scarano, Exp. Fluids 45 (2008) 927,
/// with windows that differ), and its variance is that of white noise, integral |A|^2 over integral |H|^2 of the last
/// pass. What folds over at the predictor's nodes is left out. 1 for a single pass, and for optical flow, which has
/// none.
double amplification_of_passes(CorrelationSettings const& settings);

}  // namespace gladstone
