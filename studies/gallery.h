#pragma once

#include <string>

#include "studies/device.h"

namespace gladstone {

/// Renders the seed's Figure 1 (Rajendran, Bane & Vlachos) and what belongs beside it, studies/cases/figure1/*.toml:
/// particle images as they should be, and with what spoils them. FOLDER/NAME/ is the case of each, NAME/beside.png its
/// first pulse beside the normal one at equal grey scale, gallery.png shows all.
/// @return a text that says what to look at
/// @throws SetupError, OutputError, DataError, DeviceError
std::string run_gallery(std::string const& folder, Device const& device);

}  // namespace gladstone
