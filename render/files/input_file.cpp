#include "render/files/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/input_guard.h"

namespace gladstone::inline files {
namespace {

[[noreturn]] void not_opened(std::string const& path, int error) {
  if (error == ENOENT || error == ENOTDIR)
    throw DataError(ErrorCode::missing_file, path, "does not exist; check the name");
  throw DataError(ErrorCode::unreadable_file, path,
                  std::string("cannot be opened (") + std::strerror(error) + "); check the name and the permissions");
}

void refuse_what_is_no_file(std::string const& path, mode_t mode, std::string const& wanted) {
  if (S_ISREG(mode)) return;
  if (S_ISDIR(mode)) throw DataError(ErrorCode::unreadable_file, path, "is a folder; name " + wanted);
  char const* const kind = S_ISFIFO(mode) ? "a pipe" : S_ISSOCK(mode) ? "a socket" : "a device";
  throw DataError(ErrorCode::unreadable_file, path,
                  std::string("is ") + kind +
                      " (inputs must be regular files, which have an end and can be read more than once); save "
                      "its content to a file, and name " +
                      wanted);
}

}  // namespace

InputFile::InputFile(std::string const& path, std::string const& wanted) : path_(path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) not_opened(path, errno);
  refuse_what_is_no_file(path, status.st_mode, wanted);
  // O_NONBLOCK: a pipe that has replaced the file since stat() must not block.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor_ < 0) not_opened(path, errno);
  try {
    if (::fstat(descriptor_, &status) != 0) not_opened(path, errno);
    refuse_what_is_no_file(path, status.st_mode, wanted);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
  record_input(path, status);
}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

InputFile& InputFile::operator=(InputFile&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(size_, other.size_);
  return *this;
}

std::size_t InputFile::read(std::uint64_t offset, void* to, std::size_t size) const {
  constexpr std::size_t piece = std::size_t{16} << 20;
  std::size_t done = 0;
  while (done < size) {
    throw_if_interrupted();
    ssize_t const got = ::pread(descriptor_, static_cast<char*>(to) + done, std::min(size - done, piece),
                                static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw DataError(ErrorCode::unreadable_file, path_, std::string("cannot be read (") + std::strerror(errno) + ')');
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

}  // namespace gladstone::inline files
