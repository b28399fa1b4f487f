#include "render/files/image_file.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// A picture under the name that its first bytes ask for.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  std::string const path = fuzz::file_of(input, input.starts_with("\x89PNG") ? "picture.png" : "picture.tif");
  fuzz::read(input, [&] {
    ImageMetadata metadata;
    read_image(path, &metadata);
  });
  fuzz::read(input, [&] { read_frame_pair(path); });
  return 0;
}
