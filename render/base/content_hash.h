#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace gladstone {

/// Tells contents apart: XXH64 (Collet) of the bytes, 16 hexadecimal digits. It finds what was changed, cut short or
/// damaged by accident; it is no protection against forgery.
std::string content_hash(std::string_view bytes);

/// The same of a file, chained over pieces of 16 MiB, so that files larger than memory can be hashed.
/// @throws DataError where it cannot be read
std::string file_hash(std::string const& path);

}  // namespace gladstone
