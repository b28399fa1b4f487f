#include "studies/commands/error_json.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "render/base/error.h"
#include "studies/commands/run_warnings.h"

namespace gladstone {
namespace {

using Json = nlohmann::ordered_json;

/// Removes ":number" from the end of a location and returns the number; returns 0 if there is none.
int remove_number(std::string_view& location) {
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
  int const column = remove_number(location), line = column > 0 ? remove_number(location) : 0;
  json["file"] = std::string(line > 0 ? location : std::string_view(problem.where));
  if (line > 0) {
    json["line"] = line;
    json["column"] = column;
  }
  if (!problem.key.empty()) json["key"] = problem.key;
  return json;
}

/// Returns the code of an error other than SetupError.
char const* error_code(std::exception const& error) {
  if (dynamic_cast<NoValidVector const*>(&error)) return "no_valid_vector";
  if (dynamic_cast<MemoryError const*>(&error)) return "memory";
  if (dynamic_cast<DataError const*>(&error)) return "data";
  if (dynamic_cast<OutputError const*>(&error)) return "output";
  if (dynamic_cast<DeviceError const*>(&error)) return "device";
  if (dynamic_cast<Interrupted const*>(&error)) return "interrupted";
  if (is_out_of_memory(error)) return "memory";
  return dynamic_cast<Error const*>(&error) ? "data" : "internal";
}

Json list_problems(std::exception const& error) {
  Json errors = Json::array();
  if (auto const* const setup = dynamic_cast<SetupError const*>(&error)) {
    for (SetupProblem const& problem : setup->problems()) errors.push_back(problem_json(problem));
    return errors;
  }
  Json json{{"code", error_code(error)}};
  if (auto const* const data = dynamic_cast<DataError const*>(&error)) {
    json["message"] = data->message();
    json["file"] = data->file();
  } else if (auto const* const output = dynamic_cast<OutputError const*>(&error)) {
    json["message"] = output->message();
    json["file"] = output->path();
  } else {
    json["message"] = format_user_message(error);
  }
  errors.push_back(std::move(json));
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
