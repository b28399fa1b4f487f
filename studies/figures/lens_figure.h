#pragma once

#include <string>

#include "render/optics/field_analysis.h"

namespace gladstone {

/// Draws a lens: its layout to scale with rays of every field point; below it, the spot diagrams at equal scale,
/// distortion, field curvature (tangential and sagittal foci) and relative transmitted light.
/// @throws GnuplotMissing, OutputError
void write_lens_figure(std::string const& path, Lens const& lens, ParaxialLens const& paraxial,
                       FieldAnalysis const& field);

}  // namespace gladstone
