#include "tests/fuzz/lenses.h"

// A CODE V file.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  gladstone::fuzz::read_lens(gladstone::fuzz::text_of(data, size), "lens.seq");
  return 0;
}
