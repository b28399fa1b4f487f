#include "render/base/output_file.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

#include "render/base/error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(std::string const& path, std::string const& what, int error) {
  std::string hint;
  if (error == ENOSPC || error == EDQUOT) hint = "; free some space or choose another folder";
  if (error == EACCES || error == EPERM || error == EROFS) hint = "; choose a folder that you may write to";
  if (error == ENOENT) hint = "; choose a place where a folder can be made";
  if (error == ENOTDIR) hint = "; a part of the path is a file";
  if (error == EFBIG) hint = "; raise the limit on the size of files (ulimit -f)";
  throw OutputError(path, what + " (" + std::strerror(error) + ')' + hint);
}

/// Absolute, without trailing slash; what a link points to.
fs::path final_place(std::string const& path) {
  std::error_code error;
  if (path.empty()) throw OutputError("output", "has no name; give one");
  fs::path place = fs::absolute(path, error).lexically_normal();
  if (!place.has_filename()) place = place.parent_path();
  if (fs::is_symlink(place, error) && fs::exists(place, error)) place = fs::canonical(place, error);
  if (!place.has_filename()) throw OutputError(path, "cannot be written; name a file or folder in it");
  return place;
}

/// Makes the missing folders above a place; returns those made, outermost first.
std::vector<std::string> make_parents(fs::path const& place) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path folder = place.parent_path(); !fs::exists(folder, ignored) && folder.has_filename();
       folder = folder.parent_path()) {
    missing.push_back(folder);
  }
  std::vector<std::string> made;
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) {
    if (::mkdir(folder->c_str(), 0777) == 0) {
      made.push_back(folder->string());
    } else if (errno != EEXIST) {
      int const error = errno;
      for (auto below = made.rbegin(); below != made.rend(); ++below) ::rmdir(below->c_str());
      fail(folder->string(), "the folder cannot be made", error);
    }
  }
  return made;
}

void remove_empty(std::vector<std::string> const& folders) {
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder) ::rmdir(folder->c_str());
}

std::string beside(fs::path const& place, char const* kind) {
  std::string const name = '.' + place.filename().string() + '.' + kind + '-' + std::to_string(::getpid());
  return (place.parent_path() / name).string();
}

/// Clears away what a killed run left beside the place. An old folder that it had moved aside comes back.
void clean_up_after_the_dead(fs::path const& place) {
  std::error_code error;
  std::string const partial = '.' + place.filename().string() + ".partial-";
  std::string const old = '.' + place.filename().string() + ".old-";
  std::vector<fs::path> found;
  for (fs::directory_iterator entry(place.parent_path(), error), end; !error && entry != end; entry.increment(error)) {
    found.push_back(entry->path());
  }
  for (auto const& leftover : found) {
    std::string const name = leftover.filename().string();
    bool const is_old = name.starts_with(old);
    if (!is_old && !name.starts_with(partial)) continue;
    std::string const digits = name.substr(is_old ? old.size() : partial.size());
    pid_t process = 0;
    auto const [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), process);
    if (problem != std::errc{} || end != digits.data() + digits.size() || process <= 0) continue;
    bool const mine = process == ::getpid();
    if (mine || ::kill(process, 0) == 0 || errno != ESRCH) continue;
    if (is_old && !fs::exists(place, error)) {
      fs::rename(leftover, place, error);
    } else {
      fs::remove_all(leftover, error);
    }
  }
}

/// Flushes a file or a folder's entries; 0 or the error.
int flush_to_disk(std::string const& path) {
  int const file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno;
  int const error = ::fsync(file) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
  return ::close(file) == 0 ? error : (error ? error : errno);
}

void refuse_foreign_folder(fs::path const& place, std::string const& marker_file) {
  std::error_code error;
  auto const status = fs::status(place, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw OutputError(place.string(), "is a file; name a folder");
  if (fs::is_empty(place, error) || fs::exists(place / marker_file, error)) return;
  throw OutputError(place.string(), "is not empty and was not made by gladstone (it has no " + marker_file +
                                        "); choose another folder or empty it");
}

/// Links (where the file system cannot: copies) into `fresh` what `old` holds beyond the files of `fresh` and
/// `derived`.
void keep_what_users_added(fs::path const& old, fs::path const& fresh, std::vector<std::string> const& derived) {
  std::error_code error;
  for (fs::directory_iterator entry(old, error), end; !error && entry != end; entry.increment(error)) {
    fs::path const name = entry->path().filename();
    if (fs::exists(fs::symlink_status(fresh / name))) continue;
    if (std::find(derived.begin(), derived.end(), name.string()) != derived.end()) continue;
    auto const options = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
    std::error_code problem;
    fs::copy(entry->path(), fresh / name, options | fs::copy_options::create_hard_links, problem);
    if (problem) {
      fs::remove_all(fresh / name, problem);
      fs::copy(entry->path(), fresh / name, options, problem);
    }
    if (problem)
      throw OutputError(entry->path().string(), "cannot be kept (" + problem.message() + "); move it elsewhere");
  }
}

}  // namespace

OutputFile::OutputFile(std::string const& path) {
  fs::path const place = final_place(path);
  std::error_code error;
  auto const status = fs::status(place, error);
  if (fs::is_directory(status)) throw OutputError(path, "is a folder; name a file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw OutputError(path, "is no ordinary file (a device or a pipe); name a file");
  }
  made_folders_ = make_parents(place);
  clean_up_after_the_dead(place);
  path_ = place.string();
  temporary_ = beside(place, "partial");
  int const file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) {
    int const problem = errno;
    remove_empty(made_folders_);
    fail(path_, "cannot be written", problem);
  }
  ::close(file);
}

OutputFile::~OutputFile() {
  if (committed_) return;
  ::unlink(temporary_.c_str());
  remove_empty(made_folders_);
}

void OutputFile::write(void const* data, std::size_t size) {
  int const file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(path_, "cannot be written", errno);
  auto const* bytes = static_cast<char const*>(data);
  while (size > 0) {
    ssize_t const written = ::write(file, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      int const error = written < 0 ? errno : EIO;
      ::close(file);
      fail(path_, "cannot be written", error);
    }
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
  if (::close(file) != 0) fail(path_, "cannot be written", errno);
}

void OutputFile::commit() {
  if (int const error = flush_to_disk(temporary_)) fail(path_, "cannot be written", error);
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail(path_, "cannot be put in its place", errno);
  committed_ = true;
  flush_to_disk(fs::path(path_).parent_path().string());
}

void OutputFile::write_text(std::string const& path, std::string const& text) {
  OutputFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

OutputFolder::OutputFolder(std::string const& path, std::string marker_file, std::vector<std::string> derived)
    : marker_file_(std::move(marker_file)), derived_(std::move(derived)) {
  fs::path const place = final_place(path);
  std::error_code error;
  if (fs::exists(place.parent_path(), error)) clean_up_after_the_dead(place);
  refuse_foreign_folder(place, marker_file_);
  made_folders_ = make_parents(place);
  path_ = place.string();
  temporary_ = beside(place, "partial");
  fs::remove_all(temporary_, error);
  if (::mkdir(temporary_.c_str(), 0777) != 0) {
    int const problem = errno;
    remove_empty(made_folders_);
    fail(path_, "the folder cannot be made", problem);
  }
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
  remove_empty(made_folders_);
}

void OutputFolder::commit() {
  std::error_code walk;
  for (fs::recursive_directory_iterator entry(temporary_, walk), end; !walk && entry != end; entry.increment(walk)) {
    if (!entry->is_regular_file() && !entry->is_directory()) continue;
    if (int const error = flush_to_disk(entry->path().string())) fail(path_, "cannot be written", error);
  }
  refuse_foreign_folder(path_, marker_file_);

  keep_what_users_added(path_, temporary_, derived_);

  // Without an old folder one rename does it. With one the two change places at once where the file system can do
  // that; elsewhere the old one steps aside, and back if the new one cannot take its place.
  bool const replaces = fs::exists(path_, walk);
  std::string old = temporary_;
  if (!replaces) {
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail(path_, "cannot be put in its place", errno);
  } else if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, path_.c_str(), RENAME_EXCHANGE) != 0) {
    old = beside(path_, "old");
    if (::rename(path_.c_str(), old.c_str()) != 0) fail(path_, "the old folder cannot be replaced", errno);
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) {
      int const error = errno;
      ::rename(old.c_str(), path_.c_str());
      fail(path_, "cannot be put in its place", error);
    }
  }
  committed_ = true;
  if (replaces) fs::remove_all(old, walk);
  flush_to_disk(fs::path(path_).parent_path().string());
}

}  // namespace gladstone
