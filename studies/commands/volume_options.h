#pragma once

#include <string>

#include "studies/compare/tomography.h"

namespace gladstone::inline commands {

/// Parses "sphere:12" or "cylinder:8.5", a radius in mm. @throws SetupError
VolumeSupport parse_support(std::string const& text);

}  // namespace gladstone::inline commands
