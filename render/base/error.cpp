#include "render/base/error.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <string_view>

namespace gladstone {
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

std::string problem_code_name(ProblemCode code) {
  switch (code) {
    case ProblemCode::invalid_value:
      return "invalid_value";
    case ProblemCode::unknown_key:
      return "unknown_key";
    case ProblemCode::missing_key:
      return "missing_key";
    case ProblemCode::wrong_type:
      return "wrong_type";
    case ProblemCode::out_of_range:
      return "out_of_range";
    case ProblemCode::unknown_choice:
      return "unknown_choice";
    case ProblemCode::syntax:
      return "syntax";
    case ProblemCode::memory:
      return "memory";
    case ProblemCode::unreadable_file:
      return "unreadable_file";
  }
  return "invalid_value";
}

SetupError::SetupError(std::vector<SetupProblem> problems, std::size_t more)
    : Error(joined(problems, more)), problems_(std::move(problems)), more_(more) {}

bool is_out_of_memory(std::exception const& error) {
  if (auto const* const setup = dynamic_cast<SetupError const*>(&error)) {
    return std::any_of(setup->problems().begin(), setup->problems().end(),
                       [](SetupProblem const& problem) { return problem.code == ProblemCode::memory; });
  }
  return dynamic_cast<std::bad_alloc const*>(&error) || dynamic_cast<std::length_error const*>(&error) ||
         dynamic_cast<MemoryError const*>(&error) || dynamic_cast<DeviceMemoryError const*>(&error) ||
         std::string_view(error.what()).find("(-4:Insufficient memory)") != std::string_view::npos;
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

}  // namespace gladstone
