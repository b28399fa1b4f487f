#include <algorithm>
#include <cstdlib>

#include "render/scene/cross_check.h"
#include "render/scene/read_setup.h"
#include "render/scene/setup.h"
#include "render/setup/setup_table.h"
#include "studies/case/correlation_setup.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

namespace {

/// A setup as every command reads it. @return its resolved text
std::string understood(SetupDocument document) {
  SetupTable root = document.root();
  Setup const setup = read_setup(root);
  read_correlation_settings(root.table("correlate"));
  if (!document.has_problems()) cross_check(setup, root);
  document.finish();
  return document.resolved();
}

}  // namespace

// A setup file, and behind the line "#--set" assignments of --set, one a line. What is accepted reads back to itself.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  fuzz::read(input, [&] {
    constexpr std::string_view mark = "\n#--set\n";
    std::size_t const end = std::min(input.find(mark), size);
    SetupDocument document = SetupDocument::from_text(input.substr(0, end), "setup.toml", "/nowhere");
    for (std::size_t at = end + mark.size(); at < size;) {
      std::size_t const stop = std::min(input.find('\n', at), size);
      document.override_key(std::string(input.substr(at, stop - at)));
      at = stop + 1;
    }
    std::string const once = understood(std::move(document));
    if (understood(SetupDocument::from_text(once, "resolved.toml", "/elsewhere")) != once) std::abort();
  });
  return 0;
}
