#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace gladstone::inline commands {

/// Option or positional argument of a command, as --help shows it.
struct ArgumentDescription {
  std::vector<std::string> names;    ///< names of the option, "-o", "--output"; of a positional argument its only name
  std::string text;                  ///< description
  bool takes_value = false;          ///< false: a flag
  std::vector<std::string> choices;  ///< permitted values; empty: any value, for example the name of a file
};

/// Command of the program with its options, or the program itself.
struct CommandDescription {
  std::string path;                            ///< "sweep run"; empty: the program
  std::string summary;                         ///< one sentence
  std::string example;                         ///< command line; empty: none
  std::string footer;                          ///< text after the options in --help
  std::vector<ArgumentDescription> arguments;  ///< positional arguments
  std::vector<ArgumentDescription> options;
  std::vector<CommandDescription> commands;  ///< sub-commands

  /// Returns the last word of the path: "run".
  std::string name() const { return path.substr(path.rfind(' ') + 1); }
};

/// Describes a command and its sub-commands.
/// @param app   command as CLI11 parses it
/// @param path  path of the command, see CommandDescription
CommandDescription describe_command(CLI::App const& app, std::string const& path);

/// Returns a command and all its sub-commands, in the order of --help.
std::vector<CommandDescription const*> all_commands(CommandDescription const& command);

/// Returns true if the value of an option or argument is the path of a key of a setup: --set, and `gladstone keys`.
bool takes_setup_key(CommandDescription const& command, ArgumentDescription const& argument);

/// Returns the manual page gladstone(1) in roff (macros of man(7)).
std::string manual_page(CommandDescription const& program);

}  // namespace gladstone::inline commands
