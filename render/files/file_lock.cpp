#include "render/files/file_lock.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace gladstone::inline files {
namespace {

struct flock range_of(std::size_t first, std::size_t count, short type) {
  struct flock range {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(first);
  range.l_len = static_cast<off_t>(count);
  return range;
}

/// Calls fcntl() for a lock, repeating interrupted calls. @return 0 or errno
int control(int file, int command, struct flock& range) {
  while (::fcntl(file, command, &range) != 0) {
    if (errno == EACCES) return EAGAIN;  // POSIX allows EACCES or EAGAIN for a held lock
    if (errno != EINTR) return errno;
  }
  return 0;
}

}  // namespace

int lock_bytes(int file, std::size_t first, std::size_t count) {
  struct flock range = range_of(first, count, F_WRLCK);
  return control(file, F_OFD_SETLK, range);
}

bool leads_to(std::string const& path, int file) {
  struct stat mine {};
  struct stat there {};
  return ::fstat(file, &mine) == 0 && ::stat(path.c_str(), &there) == 0 && mine.st_dev == there.st_dev &&
         mine.st_ino == there.st_ino;
}

void unlock_bytes(int file, std::size_t first, std::size_t count) {
  struct flock range = range_of(first, count, F_UNLCK);
  control(file, F_OFD_SETLK, range);
}

int find_lock(int file, std::size_t first, std::size_t count) {
  struct flock range = range_of(first, count, F_WRLCK);
  if (int const error = control(file, F_OFD_GETLK, range)) return error;
  return range.l_type == F_UNLCK ? 0 : EAGAIN;
}

}  // namespace gladstone::inline files
