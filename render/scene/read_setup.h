#pragma once

#include <vector>

#include "render/scene/setup.h"

namespace gladstone::inline scene {

/// Reads a setup of BOS, PIV or calibration from its tables. Unsupported keys and combinations are reported by name.
Setup read_setup(SetupTable root);

/// Returns the table of the camera; records a problem if the setup has several cameras.
SetupTable camera_table(SetupTable& root);

/// Returns the tables of the setup's optical elements, in the order of Setup::elements.
std::vector<ElementTable> element_tables(SetupTable root);

/// Refuses particles, laser, flow and a field at the second pulse in a setup that is not PIV.
void refuse_piv_tables(Setup const& setup, SetupTable root);

}  // namespace gladstone::inline scene
