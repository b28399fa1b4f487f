#include "studies/commands/command_description.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "render/base/version.h"

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

/// Escapes a text for roff: backslashes, hyphens, which are otherwise set as dashes, and requests at the start of a
/// line.
std::string roff_text(std::string const& text) {
  std::string result;
  for (char c : text) {
    bool const begins_line = result.empty() || result.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

/// Returns the entry of an option: "-o, --output VALUE" and its description.
std::string option_entry(ArgumentDescription const& option) {
  std::string text = ".TP\n";
  for (std::size_t i = 0; i < option.names.size(); ++i)
    text += (i > 0 ? ", " : "") + fmt::format("\\fB{}\\fR", roff_text(option.names[i]));
  bool const positional = !option.names.front().starts_with('-');
  if (!option.choices.empty()) {
    std::vector<std::string> words;
    for (std::string const& word : option.choices) words.push_back(roff_text(word));
    text += fmt::format(" {}", fmt::join(words, "|\\:"));  // a line may end after a bar
  } else if (option.takes_value && !positional) {
    text += " \\fIVALUE\\fR";
  }
  return text + '\n' + roff_text(option.text) + '\n';
}

/// Returns the entries of the arguments and options, without --help, which all commands have.
std::string entries(CommandDescription const& command) {
  std::string text;
  for (ArgumentDescription const& argument : command.arguments) text += option_entry(argument);
  for (ArgumentDescription const& option : command.options)
    if (command.path.empty() || option.names.back() != "--help") text += option_entry(option);
  return text;
}

std::string command_section(CommandDescription const& command) {
  std::string text = ".SS gladstone " + command.path + '\n' + roff_text(command.summary) + ".\n" + entries(command);
  if (!command.example.empty()) text += ".PP\nExample:\n.PP\n.EX\n" + roff_text(command.example) + "\n.EE\n";
  return text;
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

std::string manual_page(CommandDescription const& program) {
  std::string text = fmt::format(
      R"(.TH GLADSTONE 1 "{}" "gladstone {}" "User Commands"
.ad l
.SH NAME
gladstone \- synthetic BOS and PIV images by ray tracing, and their analysis
.SH SYNOPSIS
.B gladstone
.I COMMAND
.RI [ ARGUMENT " ...] [" OPTION " ...]"
.SH DESCRIPTION
gladstone renders synthetic images for background\-oriented schlieren (BOS) and particle image velocimetry (PIV),
measures the displacement on them, quantifies the error of every vector, and converts BOS vectors to density.
.PP
Experiments are described by setups, which are files in TOML.
.B gladstone init
writes a commented one,
.B gladstone keys
lists all keys with unit, default, allowed values and meaning.
Results go to the standard output, messages and progress to the standard error.
.SH OPTIONS
These options may be given before or after any command.
)",
      release_date, version);
  text += entries(program) + ".SH COMMANDS\n";
  for (CommandDescription const* one : all_commands(program))
    if (!one->path.empty()) text += command_section(*one);
  text += ".SH EXIT STATUS\n" + roff_text(program.footer) + '\n';
  text += R"(.SH ENVIRONMENT
.TP
.B GLADSTONE_IMAGE_CODECS
Folder of libgladstone_image_codecs.so, if it is not in ../lib relative to the program.
.SH EXAMPLES
.EX
gladstone init bos \-o bos.toml
gladstone render bos.toml \-o out/bos
gladstone correlate out/bos
gladstone compare out/bos
gladstone report out/bos
.EE
)";
  return text;
}

}  // namespace gladstone::inline commands
