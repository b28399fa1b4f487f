#pragma once

#include "render/optics/field_analysis.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// A lens: its layout to scale with rays of every field point; below it, the spot diagrams at equal scale,
/// distortion, field curvature (tangential and sagittal foci) and relative transmitted light.
Figure make_lens_figure(Lens const& lens, ParaxialLens const& paraxial, FieldAnalysis const& field);

}  // namespace gladstone::inline figures
