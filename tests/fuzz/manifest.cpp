#include "studies/sweep/manifest.h"

#include "tests/fuzz/input.h"

using namespace gladstone;

// A study's manifest: every line is read.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, "manifest.jsonl");
  fuzz::read(input, [&] { read_manifest_version(InputFile(path, "a manifest")); });
  fuzz::read(input, [&] {
    Manifest const manifest(path);
    for (std::size_t i = 0; i < manifest.size(); ++i) {
      manifest.line_hash(i);
      manifest[i].title();
    }
  });
  return 0;
}
