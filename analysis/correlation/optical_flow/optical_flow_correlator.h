#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/optical_flow/dense_flow.h"

namespace gladstone {

/// Measures by optical flow: the vectors of the last pass's grid are the displacement at their centres. Nothing is
/// deformed in passes or validated by neighbours, since the flow is smooth by itself; there is no peak, so that peak
/// ratio and correlation are not known. Masked where half of the window is unknown; invalid without any contrast, or
/// beyond settings.max_displacement_px.
std::unique_ptr<Correlator> make_optical_flow_correlator(CorrelationSettings const& settings, EstimateFlow estimate);

}  // namespace gladstone
