#include "render/base/content_hash.h"

#include <OpenImageIO/hash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone {
namespace {

std::uint64_t xxh64(void const* bytes, std::size_t size, std::uint64_t seed) {
  return OIIO::xxhash::XXH64(bytes, size, seed);
}

std::string hexadecimal(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

}  // namespace

std::string content_hash(std::string_view bytes) { return hexadecimal(xxh64(bytes.data(), bytes.size(), 0)); }

std::string file_hash(std::string const& path) {
  if (std::error_code error; std::filesystem::is_directory(path, error)) {
    throw DataError(path, "is a folder; a file is needed");
  }
  auto const unreadable = [&path] {
    return DataError(path, std::string("cannot be read (") + std::strerror(errno ? errno : EIO) + ')');
  };
  errno = 0;
  std::unique_ptr<FILE, int (*)(FILE*)> const file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) throw unreadable();
  std::vector<char> piece(std::size_t{16} << 20);
  std::uint64_t hash = 0;
  while (true) {
    throw_if_interrupted();
    std::size_t const size = std::fread(piece.data(), 1, piece.size(), file.get());
    if (std::ferror(file.get())) throw unreadable();
    if (size > 0) hash = xxh64(piece.data(), size, hash);
    if (size < piece.size()) return hexadecimal(hash);
  }
}

}  // namespace gladstone
