#pragma once

#include <string>

#include "studies/commands/command_description.h"

namespace gladstone::inline commands {

/// Return scripts for bash, zsh and fish that complete commands, options, their values and the keys of setups; other
/// words are names of files.
std::string bash_completion(CommandDescription const& program);
std::string zsh_completion(CommandDescription const& program);
std::string fish_completion(CommandDescription const& program);

}  // namespace gladstone::inline commands
