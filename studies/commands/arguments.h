#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gladstone {

/// Checks of an option's value; what they refuse is told in the words of refusal().
CLI::Validator one_of(std::vector<std::string> words);
CLI::Validator whole_number(long long low, long long high);

/// What a command line that cannot be parsed is answered with: one line, with the option, what is wrong with it and
/// the help to look at.
std::string refusal(CLI::App const* app, CLI::Error const& error);

}  // namespace gladstone
