#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gladstone {

/// Validators of option values; refusal() formats their messages.
CLI::Validator one_of(std::vector<std::string> words);
CLI::Validator whole_number(long long low, long long high);

/// Formats the error message for an invalid command line: one line with the option, the problem and the help command.
std::string refusal(CLI::App const* app, CLI::Error const& error);

}  // namespace gladstone
