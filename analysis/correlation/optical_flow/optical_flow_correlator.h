#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/optical_flow/dense_flow.h"

namespace gladstone::inline correlation {

/// Creates a correlator by optical flow. Its vectors are the displacements at the centres of the windows that the last
/// pass of a correlation would have. There are no passes and no validation by neighbours, since the flow is smooth;
/// peak ratio and correlation are NaN. Vectors are masked if more than half of the window is unknown, and invalid if it
/// has no contrast or the displacement exceeds settings.max_displacement_px.
std::unique_ptr<Correlator> make_optical_flow_correlator(CorrelationSettings const& settings, EstimateFlow estimate);

}  // namespace gladstone::inline correlation
