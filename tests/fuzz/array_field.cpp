#include <array>

#include "tests/fuzz/fields.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// A field of NumPy, of MATLAB, or in a table of points; the first character selects the format, and the rest is the
// file. Files of MATLAB 7.3 are left out: they are HDF5 files, whose bytes HDF5 1.10 itself does not check.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  constexpr std::array extensions{".npy", ".npz", ".mat", ".csv"};
  std::string_view const input = fuzz::text_of(data, size);
  if (input.empty() || input.find("\x89HDF") != std::string_view::npos) return 0;
  std::size_t const format = static_cast<unsigned char>(input.front()) % extensions.size();
  std::string const path = fuzz::file_of(input.substr(1), std::string("field") + extensions[format]);
  fuzz::read(input, [&] { fuzz::read_field(path); });
  fuzz::read(input, [&] { fuzz::read_field(path, 3); });
  return 0;
}
