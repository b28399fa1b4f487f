#include "render/files/content_hash.h"

#include <fmt/format.h>

#include <vector>

#define XXH_INLINE_ALL  // the functions are compiled here, so that no library is loaded for them
#include <xxhash.h>

#include "render/files/input_file.h"

namespace gladstone::inline files {
namespace {

/// Formats a hash as 16 hexadecimal digits.
std::string hexadecimal(std::uint64_t value) { return fmt::format("{:016x}", value); }

}  // namespace

std::string content_hash(std::string_view bytes) { return hexadecimal(XXH64(bytes.data(), bytes.size(), 0)); }

std::string file_hash(std::string const& path) {
  InputFile const file(path);
  std::vector<char> piece(std::size_t{16} << 20);
  std::uint64_t hash = 0;
  for (std::uint64_t offset = 0;;) {
    std::size_t const size = file.read(offset, piece.data(), piece.size());
    if (size > 0 || offset == 0) hash = XXH64(piece.data(), size, hash);
    offset += size;
    if (size < piece.size()) return hexadecimal(hash);
  }
}

}  // namespace gladstone::inline files
