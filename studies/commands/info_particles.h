#pragma once

#include <string>

#include "render/setup/setup_table.h"
#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Reports expected properties of the particles in a PIV setup for each camera: image diameter, depth of field,
/// particles per interrogation window, photons, electrons at the peak, and the smallest visible particle.
/// @param name  name of the setup in messages
/// @throws DataError if it is not the setup of a PIV experiment
Description describe_particles(SetupDocument const& setup, std::string const& name);

}  // namespace gladstone::inline commands
