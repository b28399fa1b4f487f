#include "render/files/hdf5_axes.h"

#include <cstdint>
#include <numeric>
#include <span>

namespace gladstone::inline files {

void Hdf5Axes::write_numbers(std::string const& axis, std::size_t size, std::string const& description) {
  std::vector<std::int64_t> numbers(size);
  std::iota(numbers.begin(), numbers.end(), 0);
  file_.write(axis, std::span<std::int64_t const>(numbers), {size}, "1", description, axis.substr(axis.rfind('/') + 1));
}

}  // namespace gladstone::inline files
