#include "render/optics/glass_catalogue.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// A catalogue of glasses, and every glass of it asked for.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, "made_up.agf");
  fuzz::read(input, [&] {
    GlassCatalogue catalogue;
    catalogue.add_file(path);
    for (Glass const* glass : catalogue.glasses()) {
      fuzz::read(input, [&] { catalogue.match(glass->name, 550e-9, "lens:1"); });
    }
  });
  return 0;
}
