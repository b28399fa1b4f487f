#include "render/base/error.h"

namespace gladstone {
namespace {

std::string joined(std::vector<SetupProblem> const& problems) {
  std::string text;
  for (auto const& problem : problems) {
    if (!text.empty()) text += '\n';
    text += problem.where + ": " + problem.message;
  }
  return text;
}

}  // namespace

SetupError::SetupError(std::vector<SetupProblem> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

}  // namespace gladstone
