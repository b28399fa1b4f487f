#pragma once

#include <string>
#include <vector>

#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone {

/// Takes an operand of a Zemax surface that says which light passes it: circular apertures and obscurations about the
/// axis (CLAP, FLAP, OBSC: least and largest radius). @param unit of lengths [m]
/// @return false where the operand says nothing of the kind @throws DataError naming those that are not traced
bool read_zmx_aperture(PrescriptionLine const& line, double unit, PrescribedSurface& surface);

/// Notes operands that change what a lens does and are not traced, and those that nobody here knows. Harmless ones are
/// passed over: weights, variables, names, drawings. @throws DataError where tracing on would be wrong
void note_zmx_operand(PrescriptionLine const& line, std::vector<std::string>& warnings);

}  // namespace gladstone
