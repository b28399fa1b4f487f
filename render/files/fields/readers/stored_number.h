#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>

namespace gladstone::inline files {

/// Reads a number from memory.
/// @param swap  true if its byte order is not that of the machine
template <class Stored>
double read_number(char const* bytes, bool swap) {
  std::array<char, sizeof(Stored)> value;
  std::copy_n(bytes, sizeof(Stored), value.data());
  if (swap) std::reverse(value.begin(), value.end());
  return static_cast<double>(std::bit_cast<Stored>(value));
}

/// Numeric type of a file: its size and how to read it.
struct StoredNumber {
  std::size_t bytes;
  int significant_bits;
  double (*read)(char const* bytes, bool swap);
};

template <class Stored>
constexpr StoredNumber stored_number() {
  return {sizeof(Stored), std::numeric_limits<Stored>::digits, read_number<Stored>};
}

}  // namespace gladstone::inline files
