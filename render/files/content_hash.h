#pragma once

#include <string>
#include <string_view>

namespace gladstone::inline files {

/// Computes the XXH64 hash (Collet) of the bytes as 16 hexadecimal digits. It detects accidental changes, truncation
/// and damage, but gives no protection against forgery.
std::string content_hash(std::string_view bytes);

/// Computes the XXH64 hash of a file in blocks of 16 MiB, so that files larger than memory can be hashed. The hash of
/// each block is the seed of the next one, so that a file of one block has the content_hash() of its bytes.
/// @throws DataError if the file cannot be read
std::string file_hash(std::string const& path);

}  // namespace gladstone::inline files
