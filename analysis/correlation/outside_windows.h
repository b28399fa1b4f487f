#pragma once

#include "analysis/correlation/correlation_settings.h"
#include "render/base/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone {

/// Tells windows that left the frames from masked ones: a pass deforms the frames by what is known so far, and takes
/// from beyond their rims what nobody knows. Vectors of status masked become invalid (VectorReason::outside) where
/// more of the window's pixels, moved by half the displacement around it to either side, lie outside the frames than
/// on pixels that are not finite; all of them where every pixel is finite.
/// @param field what a correlator gave for the frames with these settings
void name_windows_outside(DisplacementField& field, FramePair const& frames, CorrelationSettings const& settings);

}  // namespace gladstone
