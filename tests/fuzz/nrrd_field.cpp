#include "tests/fuzz/fields.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// An NRRD file, with its data after the header or in "data.raw" in the same folder.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  static std::string const beside = fuzz::file_of(std::string(4096, '\x3f'), "data.raw");
  std::string const path = fuzz::file_of(input, "field.nrrd");
  fuzz::read(input, [&] { fuzz::read_field(path); });
  return 0;
}
