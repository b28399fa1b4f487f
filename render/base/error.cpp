#include "render/base/error.h"

#include <algorithm>
#include <filesystem>
#include <new>

namespace gladstone::inline base {
namespace {

std::string joined(std::vector<SetupProblem> const& problems, std::size_t more) {
  std::size_t const reported = std::min(problems.size(), max_reported_problems);
  std::string text;
  for (std::size_t i = 0; i < reported; ++i) {
    if (i > 0) text += '\n';
    text += problems[i].where + ": " + problems[i].message;
  }
  more += problems.size() - reported;
  return more == 0 ? text : text + "\nand " + std::to_string(more) + (more == 1 ? " problem more" : " problems more");
}

}  // namespace

std::string error_code_name(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_value:
      return "invalid_value";
    case ErrorCode::unknown_key:
      return "unknown_key";
    case ErrorCode::missing_key:
      return "missing_key";
    case ErrorCode::wrong_type:
      return "wrong_type";
    case ErrorCode::out_of_range:
      return "out_of_range";
    case ErrorCode::unknown_choice:
      return "unknown_choice";
    case ErrorCode::syntax:
      return "syntax";
    case ErrorCode::missing_file:
      return "missing_file";
    case ErrorCode::unreadable_file:
      return "unreadable_file";
    case ErrorCode::wrong_format:
      return "wrong_format";
    case ErrorCode::damaged:
      return "damaged";
    case ErrorCode::unsupported:
      return "unsupported";
    case ErrorCode::missing_content:
      return "missing_content";
    case ErrorCode::wrong_shape:
      return "wrong_shape";
    case ErrorCode::inconsistent:
      return "inconsistent";
    case ErrorCode::changed:
      return "changed";
    case ErrorCode::undetermined:
      return "undetermined";
    case ErrorCode::no_valid_vector:
      return "no_valid_vector";
    case ErrorCode::memory:
      return "memory";
    case ErrorCode::output:
      return "output";
    case ErrorCode::overwrites_input:
      return "overwrites_input";
    case ErrorCode::device:
      return "device";
    case ErrorCode::arguments:
      return "arguments";
    case ErrorCode::interrupted:
      return "interrupted";
    case ErrorCode::internal:
      return "internal";
  }
  return "internal";
}

SetupError::SetupError(std::vector<SetupProblem> problems, std::size_t more)
    : Error(problems.empty() ? ErrorCode::invalid_value : problems.front().code, joined(problems, more)),
      problems_(std::move(problems)),
      more_(more) {}

bool is_out_of_memory(std::exception const& error) {
  if (auto const* const setup = dynamic_cast<SetupError const*>(&error)) {
    return std::any_of(setup->problems().begin(), setup->problems().end(),
                       [](SetupProblem const& problem) { return problem.code == ErrorCode::memory; });
  }
  auto const* const own = dynamic_cast<Error const*>(&error);
  return dynamic_cast<std::bad_alloc const*>(&error) || dynamic_cast<std::length_error const*>(&error) ||
         (own && own->code() == ErrorCode::memory) || dynamic_cast<DeviceMemoryError const*>(&error);
}

std::string format_user_message(std::exception const& error) {
  if (dynamic_cast<Error const*>(&error)) return error.what();
  if (dynamic_cast<std::invalid_argument const*>(&error)) return error.what();  // thrown by gladstone's own code only
  if (is_out_of_memory(error)) return "out of memory; reduce the image, the field or the number of dots";
  if (auto const* const file = dynamic_cast<std::filesystem::filesystem_error const*>(&error)) {
    return file->path1().string() + ": cannot be accessed (" + file->code().message() +
           "); check the name and the permissions";
  }
  return std::string("internal error of gladstone or of a library that it uses (") + error.what() +
         "); try other inputs, and report this error with the command line";
}

}  // namespace gladstone::inline base
