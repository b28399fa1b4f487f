#pragma once

#include <string>

#include "studies/commands/command.h"

namespace gladstone {

/// Reports expected properties of the particles in a PIV setup for each camera: image diameter, depth of field,
/// particles per interrogation window, photons, electrons at the peak, and the smallest visible particle.
/// @param path  setup file
int describe_particles(std::string const& path, GlobalOptions const& options);

}  // namespace gladstone
