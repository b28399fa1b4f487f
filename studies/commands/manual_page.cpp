#include <fmt/format.h>

#include "render/base/version.h"
#include "studies/commands/command_description.h"

namespace gladstone::inline commands {
namespace {

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
