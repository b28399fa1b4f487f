#pragma once

#include <string>

#include "studies/commands/command.h"

namespace gladstone {

/// What to expect of a PIV setup's particles, camera by camera: image diameter, depth of field, particles a window,
/// photons, electrons at the peak, the smallest particle that is seen.
/// @param path of the setup
int describe_particles(std::string const& path, GlobalOptions const& options);

}  // namespace gladstone
