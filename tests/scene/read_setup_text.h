#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "render/scene/setup.h"

namespace gladstone {

struct ReadSetup {
  Setup setup;
  std::vector<std::string> warnings;
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

/// Matches a SetupError of case.toml with a problem at `where`, "line:column", whose text contains `why`.
inline auto refused(std::string const& where, std::string const& why) {
  return testing::ThrowsMessage<SetupError>(
      testing::AllOf(testing::HasSubstr("case.toml:" + where), testing::HasSubstr(why)));
}

}  // namespace gladstone
