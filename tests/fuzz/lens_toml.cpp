#include "tests/fuzz/lenses.h"

// A prescription of our own.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  gladstone::fuzz::read_lens(gladstone::fuzz::text_of(data, size), "lens.toml");
  return 0;
}
