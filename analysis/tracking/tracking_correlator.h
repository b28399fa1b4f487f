#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"

namespace gladstone::inline tracking {

/// Creates a correlator whose vectors are the displacements of tracked dots.
///
/// - Frames: a pair, or TrackFrames for tracks over up to four frames of a sequence. The dots of the last frames of a
///   sequence are stored, so that the dots of each frame are located only once. TrackFrames::dots() receives the
///   scattered vectors.
/// - Prediction: result of the standard cross-correlation with the given settings, except its ambiguous vectors.
/// - Decorrelation test: applied to the prediction (assess_pair()). All vectors of frames that do not correlate are
///   invalid, with reason `uncorrelated`.
/// - Vectors: settings.tracking.output "grid" interpolates them to the grid of the last pass (interpolate_vectors());
///   windows that the correlation reports as masked remain masked. "scattered" returns the vectors of track_dots().
/// - sigma_px: computed from the uncertainties of the dots. On the grid, peak ratio and correlation are NaN.
/// - Warnings: those of the prediction and of track_dots().
std::unique_ptr<Correlator> make_tracking_correlator(CorrelationSettings const& settings);

/// Creates the CPU correlator of any method: make_tracking_correlator() or make_correlator().
/// @pre settings.method is one of correlation_methods()
std::unique_ptr<Correlator> make_cpu_correlator(CorrelationSettings const& settings);

}  // namespace gladstone::inline tracking
