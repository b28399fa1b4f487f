#include "studies/commands/error_json.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>

#include "render/base/error.h"
#include "studies/commands/run_warnings.h"

namespace gladstone {
namespace {

using Json = nlohmann::ordered_json;

/// Removes ":number" from the end of a location, and returns the number; 0 if it does not end with one.
int take_number(std::string_view& location) {
  std::size_t const colon = location.rfind(':');
  if (colon == std::string_view::npos || colon + 1 == location.size()) return 0;
  int number = 0;
  char const* const end = location.data() + location.size();
  auto const [stop, error] = std::from_chars(location.data() + colon + 1, end, number);
  if (error != std::errc{} || stop != end) return 0;
  location = location.substr(0, colon);
  return number;
}

Json problem_json(SetupProblem const& problem) {
  Json json{{"code", problem_code_name(problem.code)}, {"message", problem.message}};
  std::string_view location = problem.where;
  int const column = take_number(location), line = column > 0 ? take_number(location) : 0;
  json["file"] = std::string(line > 0 ? location : std::string_view(problem.where));
  if (line > 0) {
    json["line"] = line;
    json["column"] = column;
  }
  if (!problem.key.empty()) json["key"] = problem.key;
  return json;
}

Json located(char const* code, std::string const& file, std::string const& message) {
  return {{"code", code}, {"message", message}, {"file", file}};
}

Json list_problems(std::exception const& error) {
  Json errors = Json::array();
  if (auto const* const setup = dynamic_cast<SetupError const*>(&error)) {
    for (SetupProblem const& problem : setup->problems()) errors.push_back(problem_json(problem));
  } else if (auto const* const vectors = dynamic_cast<NoValidVector const*>(&error)) {
    errors.push_back(located("no_valid_vector", vectors->file(), vectors->message()));
  } else if (auto const* const memory = dynamic_cast<MemoryError const*>(&error)) {
    errors.push_back(located("memory", memory->file(), memory->message()));
  } else if (auto const* const data = dynamic_cast<DataError const*>(&error)) {
    errors.push_back(located("data", data->file(), data->message()));
  } else if (auto const* const output = dynamic_cast<OutputError const*>(&error)) {
    errors.push_back(located("output", output->path(), output->message()));
  } else {
    char const* const code = dynamic_cast<DeviceError const*>(&error)   ? "device"
                             : dynamic_cast<Interrupted const*>(&error) ? "interrupted"
                             : is_out_of_memory(error)                  ? "memory"
                             : dynamic_cast<Error const*>(&error)       ? "data"
                                                                        : "internal";
    errors.push_back({{"code", code}, {"message", format_user_message(error)}});
  }
  return errors;
}

Json with_errors(Json errors, int exit_code) {
  return {{"exit_code", exit_code}, {"errors", std::move(errors)}, {"warnings", recorded_warnings()}};
}

}  // namespace

Json error_json(std::exception const& error, int exit_code) { return with_errors(list_problems(error), exit_code); }

Json argument_error_json(std::string const& message, int exit_code) {
  return with_errors(Json::array({Json{{"code", "arguments"}, {"message", message}}}), exit_code);
}

}  // namespace gladstone
