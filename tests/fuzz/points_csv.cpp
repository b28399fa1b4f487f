#include "render/light/dot_pattern.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// The dots of a target as a table.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, "points.csv");
  fuzz::read(input, [&] { dots_from_csv(path, 10.0); });
  return 0;
}
