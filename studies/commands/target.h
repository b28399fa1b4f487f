#pragma once

#include <string>

#include "render/setup/setup_table.h"
#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Writes the dot pattern of a setup for printing.
/// @param name    name of the setup in messages
/// @param output  .pdf or .svg at true scale with a scale bar, or .csv (x_mm,y_mm)
/// @throws SetupError; DataError for a setup without dots; OutputError
Description write_target(SetupDocument const& setup, std::string const& name, std::string const& output);

}  // namespace gladstone::inline commands
