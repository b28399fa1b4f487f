#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

namespace gladstone {

/// Returns the bytes of numbers in a stored type and byte order.
template <class Stored>
std::string bytes(std::vector<double> const& values, bool big_endian = false) {
  std::string text;
  for (double const value : values) {
    auto const stored = static_cast<Stored>(value);
    char raw[sizeof(Stored)];
    std::memcpy(raw, &stored, sizeof(Stored));
    if (big_endian == (std::endian::native == std::endian::little)) std::reverse(raw, raw + sizeof(Stored));
    text.append(raw, sizeof(Stored));
  }
  return text;
}

}  // namespace gladstone
