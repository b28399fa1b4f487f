#include "render/files/output_folder.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "render/base/error.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"

namespace gladstone::inline files {
namespace {

namespace fs = std::filesystem;

constexpr char const* inside = ".";  // stem of partial directories inside the output directory itself

/// Renames without replacing an existing path. @return 0; EEXIST or ENOTEMPTY if the new path exists; another errno
int rename_new(std::string const& from, std::string const& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  struct stat there {};  // file systems without RENAME_NOREPLACE, such as NFS
  if (::lstat(to.c_str(), &there) == 0) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

/// Returns true if a directory is empty except for lost+found and partial directories of running writers.
bool is_vacant(std::string const& folder) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    if (name != "lost+found" && !belongs_to_replacement(name)) return false;
  }
  return !error;
}

}  // namespace

OutputFolder::OutputFolder(std::string const& path, FolderContent content)
    : place_(path), content_(std::move(content)) {
  struct stat there {};
  std::string const stem = sibling_stem(place_.name());
  remove_abandoned_outputs(place_.folder(), stem);
  if (::stat(place_.path().c_str(), &there) == 0) {
    if (std::string const kind = special_file(place_.path()); !kind.empty()) {
      throw OutputError(place_.asked(), "is not a folder (it is " + kind + "); name a folder");
    }
    if (!S_ISDIR(there.st_mode)) throw OutputError(place_.asked(), "is a file; name a folder");
    refuse_foreign_folder();
    remove_abandoned_outputs(place_.path());
    stage(place_.path(), inside);
    return;
  }
  place_.make_parents();
  stage(place_.folder(), stem);
}

OutputFolder::~OutputFolder() {
  partial_.reset();
  if (!committed_) place_.remove_made_parents();
}

void OutputFolder::stage(std::string const& parent, std::string const& stem) {
  try {
    partial_.emplace(parent, stem, Partial::Kind::folder);
    staged_ = (fs::path(partial_->path()) / staged_files).string();
    if (::mkdir(staged_.c_str(), 0777) != 0) throw std::system_error(errno, std::generic_category());
  } catch (std::system_error const& problem) {
    partial_.reset();
    place_.remove_made_parents();
    bool const is_there = parent == place_.path();
    place_.fail(is_there ? "cannot be written" : "the folder cannot be created", problem.code().value());
  }
}

void OutputFolder::refuse_foreign_folder() const {
  if (is_complete(place_.path(), content_) || is_vacant(place_.path())) return;
  throw OutputError(place_.asked(), "is not empty and was not made by gladstone (it has no " + content_.marker +
                                        "); choose another folder or empty it");
}

void OutputFolder::fill(std::function<void(std::string const& folder)> const& write) const {
  ProtectedWritePermit const own;
  report_final_path(staged_, place_.asked(), [&] { write(staged_); });
}

void OutputFolder::commit() {
  std::error_code walk;
  for (fs::recursive_directory_iterator entry(staged_, walk), end; !walk && entry != end; entry.increment(walk)) {
    if (!entry->is_regular_file() && !entry->is_directory()) continue;
    if (int const error = flush_to_disk(entry->path().string())) place_.fail("cannot be written", error);
  }
  struct stat there {};
  bool const begun_inside = fs::path(partial_->path()).parent_path() == place_.path();
  if (!begun_inside) {
    int const error = rename_new(staged_, place_.path());
    if (error == 0) {
      committed_ = true;
      flush_to_disk(place_.folder());
      return;
    }
    if (error != EEXIST && error != ENOTEMPTY) place_.fail("cannot be put in its place", error);
    // another process has created the directory meanwhile
    if (::stat(place_.path().c_str(), &there) != 0 || !S_ISDIR(there.st_mode)) {
      throw OutputError(place_.asked(), "is a file; name a folder");
    }
    fs::path const name = fs::path(partial_->path()).filename();
    std::string const writer = name.string().substr(sibling_stem(place_.name()).size());
    if (int const problem = partial_->move_to((fs::path(place_.path()) / (inside + writer)).string())) {
      place_.fail("cannot be put in its place", problem);
    }
  }
  refuse_foreign_folder();
  replace_files(*partial_, place_.path(), place_.asked(), content_);
  committed_ = true;
}

}  // namespace gladstone::inline files
