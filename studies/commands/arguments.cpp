#include "studies/commands/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "render/base/nearest_name.h"
#include "render/files/text_file.h"

namespace gladstone {
namespace {

/// Returns the sub-commands parsed so far, such as "sweep run ".
std::string command_path(CLI::App const* app) {
  std::string path;
  while (!app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    path += app->get_name() + ' ';
  }
  return path;
}

/// Rewords an error message of CLI11. The kind of error can only be inferred from its name and text.
std::string in_our_words(std::string const& kind, std::string const& text) {
  if (kind == "ConversionError") {  // "Could not convert: --threads = many"
    std::string_view const start = "Could not convert: ", given = " = ";
    auto const equals = text.find(given);
    if (text.starts_with(start) && equals != std::string::npos) {
      return fmt::format("{}: \"{}\" is not a valid number", text.substr(start.size(), equals - start.size()),
                         excerpt(text.substr(equals + given.size())));
    }
  }
  std::string const option = text.substr(0, text.find_first_of(": "));
  if (kind == "ArgumentMismatch") {
    if (text.find("flag override") != std::string::npos) return option + " takes no value";
    if (text.find("At Most") != std::string::npos) return "too many values for \"" + option + '"';
    return option + " needs a value";
  }
  return text;
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> words) {
  auto const check = [words](std::string const& given) {
    if (std::find(words.begin(), words.end(), given) != words.end()) return std::string();
    auto const nearest = nearest_name(given, words);
    return fmt::format("\"{}\" is not {}{}", excerpt(given), quoted_list(words),
                       nearest ? fmt::format("; did you mean \"{}\"?", *nearest) : "");
  };
  return CLI::Validator(check, fmt::format("{{{}}}", fmt::join(words, ",")));
}

CLI::Validator whole_number(long long low, long long high) {
  auto const check = [low, high](std::string const& given) {
    long long value = 0;
    auto const [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
    bool const good = error == std::errc() && end == given.data() + given.size() && value >= low && value <= high;
    return good ? std::string()
                : fmt::format("expected an integer from {1} to {2}, got \"{0}\"", excerpt(given), low, high);
  };
  return CLI::Validator(check, fmt::format("[{} - {}]", low, high));
}

std::string refusal(CLI::App const* app, CLI::Error const& error) {
  std::string const message = in_our_words(error.get_name(), error.what());
  return fmt::format("gladstone: {}{} See gladstone {}--help\n", message, message.ends_with('?') ? "" : ".",
                     command_path(app));
}

}  // namespace gladstone
