#pragma once

#include <string>

#include "studies/case/backend.h"

namespace gladstone {

/// Renders Figure 1 of Rajendran et al. (2019) and related cases, studies/cases/figure1/*.toml: ideal particle images,
/// and the effect of each imaging error. Writes one case per folder FOLDER/NAME/, its first frame next to the normal
/// one at equal grey scale as NAME/beside.png, and gallery.png with all of them.
/// @return text that describes what each image shows
/// @throws SetupError, OutputError, DataError, DeviceError
std::string run_gallery(std::string const& folder, Backend const& device);

}  // namespace gladstone
