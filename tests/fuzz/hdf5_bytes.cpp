#include "tests/fuzz/hdf5_readers.h"

using namespace gladstone;

// An HDF5 file, byte by byte.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  fuzz::read_hdf5(input, fuzz::file_of(input, "file.h5"));
  return 0;
}
