#include "studies/sweep/manifest.h"

#include "tests/fuzz/input.h"

using namespace gladstone;

// A study's manifest: every line is read.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  fuzz::read(input, [&] {
    version_of_manifest(input);
    Manifest const manifest("manifest.jsonl", std::string(input));
    for (std::size_t i = 0; i < manifest.size(); ++i) {
      manifest.line_hash(i);
      manifest[i].title();
    }
  });
  return 0;
}
