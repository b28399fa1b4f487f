#include <string>

#include "analysis/vectors/vector_file.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// Vectors in the formats that are not text, each by its ending: the same bytes as all of them, but those of HDF5 files,
// on which HDF5 1.10 itself fails if they are damaged; target hdf5_datasets varies their content.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  if (input.find("\x89HDF") != std::string_view::npos) return 0;
  for (std::string const name : {"v.nc", "v.mat", "v.vti", "v.vtp", "v.dat"}) {
    std::string const path = fuzz::file_of(input, name);
    fuzz::read(input, [&] { read_vectors(path); });
  }
  return 0;
}
