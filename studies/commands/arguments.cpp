#include "studies/commands/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <iterator>
#include <sstream>
#include <string_view>

#include "render/base/nearest_name.h"
#include "render/files/text_file.h"

namespace gladstone::inline commands {
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

std::vector<std::string> split_words(std::string const& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// Returns a validator of numbers that satisfy a condition.
/// @param wanted  description for the message: "a number above 0"
CLI::Validator number_that(std::function<bool(double)> const& accepts, std::string const& wanted,
                           std::string const& help) {
  auto const check = [accepts, wanted](std::string const& given) {
    double value = 0;
    bool const good = CLI::detail::lexical_cast(given, value) && std::isfinite(value) && accepts(value);
    return good ? std::string() : fmt::format("expected {}, got \"{}\"", wanted, excerpt(given));
  };
  return CLI::Validator(check, help);
}

/// Rewords an error message of CLI11. The kind of error can only be inferred from its name and text.
std::string in_our_words(std::string const& kind, std::string const& text) {
  if (kind == "ConversionError") {  // "Could not convert: --threads = many"
    std::string_view const start = "Could not convert: ", given = " = ";
    auto const equals = text.find(given);
    if (text.starts_with(start) && equals != std::string::npos) {
      return fmt::format("{}: expected a number, got \"{}\"", text.substr(start.size(), equals - start.size()),
                         excerpt(text.substr(equals + given.size())));
    }
  }
  std::string const option = text.substr(0, text.find_first_of(": "));
  if (kind == "ArgumentMismatch") {
    if (text.find("flag override") != std::string::npos) return option + " takes no value";
    // "--sheet-slope: At least 2 required but received 1"
    std::vector<std::string> words = split_words(text);
    if (words.size() < 5 || words[4] != "required" || words.back() == "0") return option + " needs a value";
    bool const too_many = text.find("At Most") != std::string::npos;
    return fmt::format("{} needs {}{} value{}, got {}", option, too_many ? "at most " : "", words[3],
                       words[3] == "1" ? "" : "s", words.back());
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

CLI::Validator number(double low, double high) {
  return number_that([low, high](double value) { return value >= low && value <= high; },
                     fmt::format("a number from {:g} to {:g}", low, high), fmt::format("[{:g} - {:g}]", low, high));
}

CLI::Validator positive_number() {
  return number_that([](double value) { return value > 0; }, "a number above 0", "POSITIVE");
}

CLI::Validator non_negative_number() {
  return number_that([](double value) { return value >= 0; }, "a number of at least 0", "NONNEGATIVE");
}

std::string describe_problem(CLI::Error const& error) { return in_our_words(error.get_name(), error.what()); }

std::string find_argument(CLI::Error const& error) {
  std::string const problem = describe_problem(error);  // begins with its name
  return problem.substr(0, problem.find_first_of(": "));
}

std::string refusal(CLI::App const* app, CLI::Error const& error) {
  std::string const message = describe_problem(error);
  return fmt::format("gladstone: {}{} See gladstone {}--help\n", message, message.ends_with('?') ? "" : ".",
                     command_path(app));
}

}  // namespace gladstone::inline commands
