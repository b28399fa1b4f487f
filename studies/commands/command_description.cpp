#include "studies/commands/command_description.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace gladstone::inline commands {
namespace {

/// Returns the words of one_of() in the type of an option: "TEXT:{auto,cpu,cuda}".
std::vector<std::string> choices_of(CLI::Option const& option) {
  std::string const type = option.get_type_name();
  std::size_t const open = type.find('{'), close = type.find('}');
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos) return words;
  for (std::size_t start = open + 1; start < close;) {
    std::size_t const end = std::min(type.find(',', start), close);
    words.push_back(type.substr(start, end - start));
    start = end + 1;
  }
  return words;
}

ArgumentDescription describe_argument(CLI::Option const& option) {
  ArgumentDescription argument{{}, option.get_description(), option.get_items_expected_max() > 0, choices_of(option)};
  for (std::string const& name : option.get_snames()) argument.names.push_back('-' + name);
  for (std::string const& name : option.get_lnames()) argument.names.push_back("--" + name);
  if (option.get_positional()) argument.names = {option.get_name(true)};
  return argument;
}

/// Returns the first command line of a footer: "Example:\n  gladstone keys f_number\n".
std::string example_of(std::string const& footer) {
  std::string const start = "Example:\n  ";
  if (!footer.starts_with(start)) return "";
  return footer.substr(start.size(), footer.find('\n', start.size()) - start.size());
}

}  // namespace

CommandDescription describe_command(CLI::App const& app, std::string const& path) {
  CommandDescription command{path, app.get_description(), example_of(app.get_footer()), app.get_footer(), {}, {}, {}};
  for (CLI::Option const* option : app.get_options()) {
    (option->get_positional() ? command.arguments : command.options).push_back(describe_argument(*option));
  }
  for (CLI::App const* one : app.get_subcommands([](CLI::App const*) { return true; })) {
    command.commands.push_back(describe_command(*one, (path.empty() ? "" : path + ' ') + one->get_name()));
  }
  return command;
}

std::vector<CommandDescription const*> all_commands(CommandDescription const& command) {
  std::vector<CommandDescription const*> all{&command};
  for (CommandDescription const& one : command.commands) {
    std::vector<CommandDescription const*> const below = all_commands(one);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

bool takes_setup_key(CommandDescription const& command, ArgumentDescription const& argument) {
  return argument.names.back() == "--set" || (command.path == "keys" && argument.names.back() == "pattern");
}

}  // namespace gladstone::inline commands
