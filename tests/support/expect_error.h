#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <string>
#include <utility>

#include "render/base/error.h"

/// Matchers of errors by code and place, so that the wording of messages is free:
/// EXPECT_THAT([&] { read_image(path); }, ThrowsDataError(ErrorCode::damaged, "cut.tif"));
namespace gladstone {

inline void PrintTo(ErrorCode code, std::ostream* out) { *out << error_code_name(code); }

inline void PrintTo(Error const& error, std::ostream* out) {
  *out << error_code_name(error.code()) << " at \"" << error.place() << "\": " << error.message();
}

inline void PrintTo(SetupProblem const& problem, std::ostream* out) {
  *out << error_code_name(problem.code) << " at \"" << problem.where << "\": " << problem.message;
}

/// Returns "CODE at PLACE" with the name of the file without its folders: "damaged at cut.tif".
inline std::string code_and_place(ErrorCode code, std::string const& place) {
  return error_code_name(code) + " at " + place.substr(place.rfind('/') + 1);
}
inline std::string code_and_place(Error const& error) { return code_and_place(error.code(), error.place()); }
inline std::string code_and_place(SetupProblem const& problem) { return code_and_place(problem.code, problem.where); }

/// Returns "CODE at PLACE" of the error that an action throws, one for each problem of a setup; empty if it succeeds.
template <class Action>
std::string error_of(Action const& action) {
  try {
    action();
  } catch (SetupError const& error) {
    std::string found;
    for (SetupProblem const& one : error.problems()) found += (found.empty() ? "" : ", ") + code_and_place(one);
    return found;
  } catch (Error const& error) {
    return code_and_place(error);
  }
  return "";
}

/// Matches a function that throws a DataError. @param place  end of the error's place, such as "bad.csv:2"
inline auto ThrowsDataError(ErrorCode code, std::string place) {
  return testing::Throws<DataError>(
      testing::AllOf(testing::Property("code", &Error::code, code),
                     testing::Property("place", &Error::place, testing::EndsWith(std::move(place)))));
}

/// Matches a function that throws a DataError and whose message also matches, for tests about a number or a remedy in
/// the message.
template <class Message>
auto ThrowsDataError(ErrorCode code, std::string place, Message const& message) {
  return testing::AllOf(ThrowsDataError(code, std::move(place)), testing::ThrowsMessage<DataError>(message));
}

/// Matches a function that throws an OutputError. @param path end of the output file's path
inline auto ThrowsOutputError(std::string path, ErrorCode code = ErrorCode::output) {
  return testing::Throws<OutputError>(
      testing::AllOf(testing::Property("code", &Error::code, code),
                     testing::Property("place", &Error::place, testing::EndsWith(std::move(path)))));
}

/// Matches a function that throws a SetupError with a problem of this code at this place.
/// @param place  key path of the problem, or end of its location, such as "case.toml:3:1"
inline auto ThrowsSetupError(ErrorCode code, std::string const& place) {
  auto const is_it = [code, place](SetupProblem const& one) {
    return one.code == code && (one.key == place || one.where.ends_with(place));
  };
  return testing::Throws<SetupError>(
      testing::Property("problems", &SetupError::problems, testing::Contains(testing::Truly(is_it))));
}

}  // namespace gladstone
