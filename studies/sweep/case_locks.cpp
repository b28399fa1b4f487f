#include "studies/sweep/case_locks.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "render/base/error.h"
#include "render/files/file_lock.h"
#include "studies/sweep/manifest.h"

namespace gladstone::inline sweep {
namespace {

[[noreturn]] void no_locks(std::string const& path, int error) {
  throw OutputError(path, fmt::format("cannot be locked ({}); put the run on a file system with locks, such as a local "
                                      "disk or NFS with lockd",
                                      std::strerror(error)));
}

/// Opens the claims file. @return -1 with errno set if it cannot be opened
int open_claims(std::string const& path, CaseLocks::Use use) {
  return ::open(path.c_str(), (use == CaseLocks::Use::take ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC, 0666);
}

[[noreturn]] void not_opened(std::string const& path, CaseLocks::Use use, int error) {
  if (use == CaseLocks::Use::take && (error == EACCES || error == EPERM || error == EROFS)) {
    throw OutputError(path, fmt::format("is read-only ({}), but the process that computes a case must lock it there; "
                                        "grant write permission in {}, or run a copy of the study",
                                        std::strerror(error), std::filesystem::path(path).parent_path().string()));
  }
  throw OutputError(path, fmt::format("cannot be opened ({})", std::strerror(error)));
}

}  // namespace

CaseLocks::CaseLocks(std::string const& run, Use use)
    : path_((std::filesystem::path(run) / run_file::claims).string()) {
  file_ = open_claims(path_, use);
  if (file_ < 0 && (use == Use::take || errno != ENOENT)) not_opened(path_, use, errno);
}

CaseLocks::~CaseLocks() {
  if (file_ >= 0) ::close(file_);
}

bool CaseLocks::take(std::size_t index) {
  bool taken = lock(index);
  // Limit the attempts: on some file systems the inode number changes with every call.
  for (int attempt = 0; attempt < 5 && !leads_to(path_, file_); ++attempt) {
    int const fresh = open_claims(path_, Use::take);
    if (fresh < 0) not_opened(path_, Use::take, errno);
    ::close(std::exchange(file_, fresh));
    taken = lock(index);
  }
  return taken;
}

bool CaseLocks::lock(std::size_t index) {
  int const error = lock_bytes(file_, index, 1);
  if (error != 0 && error != EAGAIN) no_locks(path_, error);
  return error == 0;
}

void CaseLocks::release(std::size_t index) { unlock_bytes(file_, index, 1); }

bool CaseLocks::held(std::size_t index) const { return held_from(index, 1); }
bool CaseLocks::any_held() const { return held_from(0, 0); }

bool CaseLocks::held_from(std::size_t first, std::size_t count) const {
  if (file_ < 0) return false;
  int const error = find_lock(file_, first, count);
  if (error != 0 && error != EAGAIN) no_locks(path_, error);
  return error == EAGAIN;
}

}  // namespace gladstone::inline sweep
