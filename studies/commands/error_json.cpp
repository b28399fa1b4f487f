#include "studies/commands/error_json.h"

#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "render/base/error.h"
#include "studies/case/warning_json.h"
#include "studies/commands/run_warnings.h"

namespace gladstone::inline commands {
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

/// Returns true if a place without a line is a file or folder: one that exists, or that the code reports as absent or
/// not writable. Other places are options, keys and names of inputs, such as "views".
bool is_file(ErrorCode code, std::string_view place) {
  if (place.empty() || place.starts_with("--") || code == ErrorCode::arguments) return false;
  std::error_code error;
  return code == ErrorCode::missing_file || code == ErrorCode::unreadable_file || code == ErrorCode::output ||
         code == ErrorCode::overwrites_input || std::filesystem::exists(place, error);
}

/// Describes one problem; a location "file:line:column" or "file:line" is divided into its parts.
Json problem_json(ErrorCode code, std::string const& message, std::string_view place, std::string const& key) {
  Json json{{"code", error_code_name(code)}, {"message", message}};
  if (!place.empty()) json["place"] = place;
  if (place.empty() && !key.empty()) json["place"] = key;
  bool const is_option = place.starts_with("--");  // a value such as 10:20 is not a line
  int const last = is_option ? 0 : remove_number(place), before = last > 0 ? remove_number(place) : 0;
  if (last > 0 || is_file(code, place)) json["file"] = place;
  if (last > 0) json["line"] = before > 0 ? before : last;
  if (before > 0) json["column"] = last;
  if (!key.empty()) json["key"] = key;
  return json;
}

Json list_problems(std::exception const& error) {
  if (auto const* const setup = dynamic_cast<SetupError const*>(&error)) {
    Json errors = Json::array();
    for (SetupProblem const& problem : setup->problems()) {
      errors.push_back(problem_json(problem.code, problem.message, problem.where, problem.key));
    }
    return errors;
  }
  if (auto const* const own = dynamic_cast<Error const*>(&error)) {
    std::string const key = own->key();
    return Json::array({problem_json(own->code(), own->message(), key.empty() ? own->place() : "", key)});
  }
  ErrorCode const code = is_out_of_memory(error) ? ErrorCode::memory : ErrorCode::internal;
  return Json::array({problem_json(code, format_user_message(error), "", "")});
}

Json with_errors(Json errors, int exit_code) {
  Warnings const warnings = recorded_warnings();
  return {{"exit_code", exit_code},
          {"errors", std::move(errors)},
          {"warnings", to_strings(warnings)},
          {"warning_records", warnings}};
}

}  // namespace

Json error_json(std::exception const& error, int exit_code) { return with_errors(list_problems(error), exit_code); }

Json argument_error_json(std::string const& place, std::string const& message, int exit_code) {
  Json problem = problem_json(ErrorCode::arguments, message, "", "");
  if (!place.empty()) problem["place"] = place;
  return with_errors(Json::array({std::move(problem)}), exit_code);
}

}  // namespace gladstone::inline commands
