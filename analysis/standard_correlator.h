#pragma once

#include <memory>

#include "analysis/correlator.h"
#include "analysis/window_ops.h"

namespace gladstone {

/// Standard cross-correlation in passes: every pass deforms both images by what the one before found (validated,
/// smoothed), correlates smaller windows, and adds what is left. The first pass looks for shifts up to half a window,
/// the later ones up to a quarter. Only predictors are smoothed, never the result.
std::unique_ptr<Correlator> make_standard_correlator(CorrelationSettings const& settings);

/// The weighting by its name. @pre "gaussian" or "uniform"
WindowWeighting window_weighting(CorrelationSettings const& settings);

}  // namespace gladstone
