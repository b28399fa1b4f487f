#pragma once

#include <string>

#include "studies/case/backend.h"

namespace gladstone::inline examples {

/// Renders Figure 1 of Rajendran et al. (2019) and related cases, studies/cases/figure1/*.toml: ideal particle images,
/// and the effect of each imaging error. Writes one case per folder FOLDER/NAME/. NAME/beside.png shows its first frame
/// next to that of the normal case at equal grey scale; gallery.png shows all of them.
/// @return text that describes what each image shows
/// @throws SetupError, OutputError, DataError, DeviceError
std::string run_gallery(std::string const& folder, Backend const& device);

}  // namespace gladstone::inline examples
