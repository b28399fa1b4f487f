#pragma once

#include <exception>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace gladstone::inline commands {

/// Describes an error as a JSON object, for --json: `exit_code`, `warnings`, and `errors` with one object per problem:
/// `code`, `message` and, if known, `place`, `file`, `line`, `column` and `key`.
/// The codes are those of ErrorCode.
nlohmann::ordered_json error_json(std::exception const& error, int exit_code);

/// Describes the error of a command line that cannot be parsed, in the same form.
/// @param place  option or argument that causes it
nlohmann::ordered_json argument_error_json(std::string const& place, std::string const& message, int exit_code);

}  // namespace gladstone::inline commands
