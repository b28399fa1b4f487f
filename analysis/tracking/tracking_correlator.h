#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"
#include "analysis/tracking/dot_tracking.h"

namespace gladstone::tracking {

/// Creates a correlator whose vectors are those of tracked dots, interpolated to the grid of the last pass.
///
/// The predictor is the standard cross-correlation with the given settings; its ambiguous vectors do not count. Windows
/// that the correlation reports as masked remain masked. sigma_px is propagated from the uncertainties of the dots
/// (interpolate_vectors()); peak ratio and correlation are NaN.
std::unique_ptr<Correlator> make_tracking_correlator(CorrelationSettings const& settings,
                                                     TrackingSettings const& tracking = {},
                                                     GaussianWindow const& window = {});

}  // namespace gladstone::tracking
