#include "render/base/text_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "render/base/error.h"

namespace gladstone {

std::string read_text_file(std::string const& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw DataError(path, "cannot be read (it is a folder)");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    throw DataError(path, std::string("cannot be read (") + std::strerror(errno ? errno : EIO) + ')');
  }
  return text;
}

}  // namespace gladstone
