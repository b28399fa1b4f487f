#pragma once

#include "analysis/correlation/correlation_settings.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone::inline correlation {

/// Changes the status of masked vectors whose windows were moved out of the frames to invalid (VectorReason::outside).
/// Such vectors are reported as masked at first, because passes deform the frames by the predictor and count pixels
/// from beyond the borders as unknown. A vector is changed if, with its window shifted by half the surrounding
/// displacement in each frame, more of its pixels are outside the frames than are non-finite. If all pixels of the
/// frames are finite, all masked vectors are changed.
/// @param field  result of a correlator for these frames and settings
void mark_windows_outside(DisplacementField& field, StoredFrames const& frames, CorrelationSettings const& settings);

}  // namespace gladstone::inline correlation
