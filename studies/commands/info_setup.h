#pragma once

#include <string>

#include "render/setup/setup_table.h"
#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Reports what follows from a setup before it is rendered, for each camera (make_setup_overview()), and draws the
/// layout.
/// @param name    name of the setup in messages
/// @param figure  file of the layout; empty: none. With several cameras, "_NAME" is appended to its stem.
/// @throws SetupError, DataError; OutputError if a figure cannot be written
Description describe_setup(SetupDocument const& setup, std::string const& name, std::string const& figure);

}  // namespace gladstone::inline commands
