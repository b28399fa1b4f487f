#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace gladstone::inline commands {

/// Help of the option --csv.
inline constexpr char const* csv_help = "Print the quantities as CSV: key, symbol, label, value, unit and source";

/// Validators of option values; refusal() formats their messages.
CLI::Validator one_of(std::vector<std::string> words);
CLI::Validator whole_number(long long low, long long high);
/// Accepts numbers from `low` to `high`.
CLI::Validator number(double low, double high);
CLI::Validator positive_number();
CLI::Validator non_negative_number();

/// Returns what is wrong with a command line: the option and the problem.
std::string describe_problem(CLI::Error const& error);

/// Returns the option or argument that a problem of a command line is about, such as "--threads".
std::string find_argument(CLI::Error const& error);

/// Formats the error message for an invalid command line: one line with describe_problem() and the help command.
std::string refusal(CLI::App const* app, CLI::Error const& error);

}  // namespace gladstone::inline commands
