#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "render/scene/cross_check.h"
#include "render/scene/read_setup.h"
#include "render/scene/setup.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"

namespace gladstone {

struct ReadSetup {
  Setup setup;
  Warnings warnings;
};

/// Reads and cross-checks a setup, case.toml, as the commands do.
/// @throws SetupError
inline ReadSetup read_setup_text(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "case.toml");
  ReadSetup result{read_setup(document.root()), {}};
  if (!document.has_problems()) result.warnings = cross_check(result.setup, document.root());
  document.finish();
  return result;
}

/// Matches a function that throws a SetupError with a problem of case.toml. @param where beginning of the problem's
/// "line:column"
inline auto refused(ErrorCode code, std::string const& where) {
  auto const is_it = [code, begin = "case.toml:" + where](SetupProblem const& one) {
    return one.code == code && one.where.starts_with(begin);
  };
  return testing::Throws<SetupError>(
      testing::Property("problems", &SetupError::problems, testing::Contains(testing::Truly(is_it))));
}

/// Like refused() above, for tests about a number in the message.
inline auto refused(ErrorCode code, std::string const& where, std::string const& number) {
  return testing::AllOf(refused(code, where), testing::ThrowsMessage<SetupError>(testing::HasSubstr(number)));
}

}  // namespace gladstone
