#include "render/files/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "render/base/error.h"
#include "render/files/file_kind.h"
#include "render/files/input_guard.h"
#include "render/files/stop_point.h"

namespace gladstone::inline files {
namespace {

namespace fs = std::filesystem;

/// Returns true if a single file is mounted at the path (a container volume): it can be written to, but not replaced.
bool is_mount(std::string const& path) {
  struct statx found {};
  return ::statx(AT_FDCWD, path.c_str(), 0, 0, &found) == 0 && (found.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) &&
         (found.stx_attributes & STATX_ATTR_MOUNT_ROOT);
}

}  // namespace

int flush_to_disk(std::string const& path) {
  int const file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  int const error = ::fsync(file) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
  return ::close(file) == 0 ? error : (error ? error : errno);
}

OutputFile::OutputFile(std::string const& path, std::string const& kind) : place_(path) {
  std::error_code error;
  if (fs::is_directory(place_.path(), error)) throw OutputError(place_.asked(), "is a folder; name a file");
  if (std::string const special = special_file(place_.path()); !special.empty()) {
    throw OutputError(place_.asked(), "is not a regular file (it is " + special + "); name a file");
  }
  if (is_mount(place_.path())) {
    throw OutputError(place_.asked(),
                      "cannot be replaced (it is a mount point); mount its folder, or name another file");
  }
  refuse_recorded_input(place_.path(), place_.asked());
  refuse_protected_file(place_.path(), place_.asked());
  if (!kind.empty()) refuse_replacing(kind);
  place_.make_parents();
  std::string const stem = sibling_stem(place_.name());
  remove_abandoned_outputs(place_.folder(), stem);
  try {
    partial_.emplace(place_.folder(), stem, Partial::Kind::file);
  } catch (std::system_error const& problem) {
    place_.remove_made_parents();
    place_.fail("cannot be written", problem.code().value());
  }
}

OutputFile::~OutputFile() {
  partial_.reset();
  if (!committed_) place_.remove_made_parents();
}

void OutputFile::write(void const* data, std::size_t size) {
  int const file = partial_->descriptor();
  if (::ftruncate(file, 0) != 0) place_.fail("cannot be written", errno);
  auto const* bytes = static_cast<char const*>(data);
  for (std::size_t done = 0; done < size;) {
    ssize_t const written = ::pwrite(file, bytes + done, size - done, static_cast<off_t>(done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) place_.fail("cannot be written", written < 0 ? errno : EIO);
    done += static_cast<std::size_t>(written);
  }
}

void OutputFile::refuse_replacing(std::string const& kind) const {
  std::string const old = file_kind(place_.path());
  if (old.empty() || old == kind) return;
  throw OutputError(place_.asked(), "contains data of another kind (" + old + "), and would be overwritten" +
                                        (kind.empty() ? "" : " by " + kind) +
                                        "; choose another output, or remove this file");
}

void OutputFile::commit() {
  stop_point("file-written");
  refuse_recorded_input(place_.path(), place_.asked());
  struct stat old {};
  if (::stat(place_.path().c_str(), &old) == 0) {
    refuse_replacing(file_kind(partial_->path(), place_.name()));
    ::fchmod(partial_->descriptor(), old.st_mode & 07777);
  }
  if (::fsync(partial_->descriptor()) != 0 && errno != EINVAL && errno != EROFS)
    place_.fail("cannot be written", errno);
  if (int const error = partial_->move_to(place_.path())) place_.fail("cannot be put in its place", error);
  record_output(partial_->descriptor());
  partial_->keep();
  committed_ = true;
  flush_to_disk(place_.folder());
}

void OutputFile::write_text(std::string const& path, std::string const& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace gladstone::inline files
