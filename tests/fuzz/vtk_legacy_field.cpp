#include "tests/fuzz/fields.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// A legacy VTK file: as a velocity, and as a density.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, "field.vtk");
  fuzz::read(input, [&] { fuzz::read_field(path, 3); });
  fuzz::read(input, [&] { fuzz::read_field(path); });
  return 0;
}
