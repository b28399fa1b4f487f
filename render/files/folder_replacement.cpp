#include "render/files/folder_replacement.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <set>
#include <system_error>
#include <thread>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"
#include "render/files/stop_point.h"

namespace gladstone::inline files {
namespace {

namespace fs = std::filesystem;

constexpr char const* replacing = ".replacing";
constexpr char const* old_files = "old";
constexpr char const* retired_files = "retired";

/// Exception: a file could not be moved.
struct MoveError {
  fs::path path;
  int error;
};

bool is_there(fs::path const& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0;
}

/// Renames a file, creating the parent directories of the new path. @return false if the file does not exist
bool move_file(fs::path const& from, fs::path const& to) {
  if (!is_there(from)) return false;
  std::error_code ignored;  // if it fails, rename() reports the error
  fs::create_directories(to.parent_path(), ignored);
  if (::rename(from.c_str(), to.c_str()) == 0) return true;
  throw MoveError{from, errno};
}

/// Returns the files below a directory, as relative paths. The marker file (FolderContent::marker) is the last one.
std::vector<fs::path> files_below(fs::path const& folder, std::string const& marker) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    bool const is_folder = entry->is_directory(error) && !entry->is_symlink(error);
    if (!is_folder) files.push_back(entry->path().lexically_relative(folder));
  }
  std::sort(files.begin(), files.end());
  std::stable_partition(files.begin(), files.end(), [&](fs::path const& file) { return file != marker; });
  return files;
}

/// Returns the files of a directory that a replacement removes, the marker first: the files that are written again, and
/// the derived files in the same subdirectories.
std::vector<fs::path> files_to_retire(fs::path const& staged, fs::path const& folder, FolderContent const& content) {
  std::vector<fs::path> files = files_below(staged, content.marker);
  std::set<fs::path> const anew(files.begin(), files.end());
  std::set<fs::path> parts{fs::path()};
  for (fs::path const& file : anew) parts.insert(file.parent_path());
  for (fs::path const& part : parts) {
    std::error_code error;
    for (fs::directory_iterator entry(folder / part, error), end; !error && entry != end; entry.increment(error)) {
      fs::path const file = part / entry->path().filename();
      if (is_derived(file.filename().string(), content) && !anew.contains(file)) files.push_back(file);
    }
  }
  std::stable_partition(files.begin(), files.end(), [&](fs::path const& file) { return file == content.marker; });
  return files;
}

/// Step 2 of replace_files(): moves the files to be replaced to .replacing/old, then renames it to .replacing/retired.
void retire(fs::path const& folder, FolderContent const& content) {
  fs::path const work = folder / replacing;
  if (is_there(work / retired_files)) return;
  if (::mkdir((work / old_files).c_str(), 0777) != 0 && errno != EEXIST) throw MoveError{work / old_files, errno};
  for (fs::path const& file : files_to_retire(work / staged_files, folder, content)) {
    move_file(folder / file, work / old_files / file);
  }
  move_file(work / old_files, work / retired_files);
}

/// Step 3 of replace_files(): moves the new files to their final places, the marker last.
void install(fs::path const& folder, FolderContent const& content) {
  fs::path const staged = folder / replacing / staged_files;
  for (fs::path const& file : files_below(staged, content.marker)) move_file(staged / file, folder / file);
}

/// Undoes retire() and install() as far as they were completed. @param files  new files, as relative paths
void go_back(fs::path const& folder, FolderContent const& content, std::vector<fs::path> const& files) {
  fs::path const work = folder / replacing;
  try {
    if (is_there(work / retired_files)) {
      for (fs::path const& file : files) {
        if (!is_there(work / staged_files / file)) move_file(folder / file, work / staged_files / file);
      }
      move_file(work / retired_files, work / old_files);
    }
    for (fs::path const& file : files_below(work / old_files, content.marker)) {
      move_file(work / old_files / file, folder / file);
    }
  } catch (MoveError const& stuck) {
    throw OutputError(stuck.path.string(), std::string("cannot be moved back (") + std::strerror(stuck.error) +
                                               ") after the new files could not be installed; the old files are in " +
                                               work.string() + ": move them back by hand");
  }
}

/// Throws OutputError before anything is moved if a directory exists where a file is to be written, or a file where a
/// directory is needed, or if a file to be replaced is an input of the command.
void refuse_what_is_in_the_way(fs::path const& staged, fs::path const& folder, std::string const& asked,
                               FolderContent const& content) {
  for (fs::path const& file : files_to_retire(staged, folder, content)) {
    std::error_code error;
    refuse_recorded_input(folder / file, fs::path(asked) / file);
    if (fs::is_directory(fs::symlink_status(folder / file, error))) {
      throw OutputError((fs::path(asked) / file).string(),
                        "is a folder, but a file is to be written there; move it elsewhere");
    }
    fs::path const above = folder / file.parent_path();
    if (fs::exists(above, error) && !fs::is_directory(above, error)) {
      throw OutputError((fs::path(asked) / file.parent_path()).string(),
                        "is a file, but a folder is needed there; move it elsewhere");
    }
  }
}

}  // namespace

bool is_derived(std::string const& name, FolderContent const& content) {
  return std::any_of(content.derived.begin(), content.derived.end(), [&name](std::string const& pattern) {
    auto const star = pattern.find('*');
    if (star == std::string::npos) return name == pattern;
    return name.size() + 1 >= pattern.size() && name.starts_with(pattern.substr(0, star)) &&
           name.ends_with(pattern.substr(star + 1));
  });
}

void complete_parent_replacement(std::string const& folder, FolderContent const& content) {
  fs::path const part = fs::absolute(fs::path(folder) / "").parent_path();
  fs::path const work = part.parent_path() / replacing;
  for (char const* of : {staged_files, old_files, retired_files}) {
    if (is_there(work / of / part.filename())) return complete_replacement(part.parent_path().string(), content);
  }
}

bool is_complete(std::string const& folder, FolderContent const& content) {
  fs::path const marker = fs::path(folder) / content.marker, work = fs::path(folder) / replacing;
  do {
    complete_replacement(folder, content);
    if (is_there(marker)) return true;
  } while (is_there(work));  // repeat if another replacement began after complete_replacement()
  return is_there(marker);
}

bool belongs_to_replacement(std::string const& name) { return name == replacing || is_partial(name, "."); }

void replace_files(Partial& partial, std::string const& folder, std::string const& asked,
                   FolderContent const& content) {
  fs::path const work = fs::path(folder) / replacing;
  std::string const name = partial.path();
  std::vector<fs::path> const files = files_below(fs::path(name) / staged_files, content.marker);
  refuse_what_is_in_the_way(fs::path(name) / staged_files, folder, asked, content);
  auto const fail = [&asked](std::string const& what, int error) {
    throw OutputError(asked, what + " (" + std::strerror(error) +
                                 "); the old files are unchanged: check the permissions and the free space of the "
                                 "folder");
  };
  if (::mkdir((fs::path(name) / old_files).c_str(), 0777) != 0) fail("cannot be written", errno);
  // rename() does not replace a directory that is not empty: an existing .replacing is completed first.
  while (int const error = partial.move_to(work.string())) {
    if (error != ENOTEMPTY && error != EEXIST) fail("its files cannot be replaced", error);
    complete_replacement(folder, content);
  }
  flush_to_disk(folder);
  stop_point("replacement-begun");
  try {
    retire(folder, content);
    stop_point("replacement-retired");
    install(folder, content);
    stop_point("replacement-installed");
  } catch (MoveError const& stuck) {
    try {
      go_back(folder, content, files);
    } catch (...) {
      partial.keep();
      throw;
    }
    partial.move_to(name);
    fail(stuck.path.filename().string() + " cannot be replaced", stuck.error);
  } catch (...) {
    partial.keep();  // the next writer completes the replacement
    throw;
  }
  partial.move_to(name);
  flush_to_disk(folder);
}

void complete_replacement(std::string const& folder, FolderContent const& content) {
  fs::path const work = fs::path(folder) / replacing;
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (is_there(work)) {
    if (auto const taken = AbandonedOutput::take(work.string())) {
      std::string const aside = (fs::path(folder) / taken->name(".")).string();
      try {
        retire(folder, content);
        install(folder, content);
      } catch (MoveError const& stuck) {
        throw OutputError(stuck.path.string(),
                          std::string("cannot be moved (") + std::strerror(stuck.error) +
                              "); an earlier command was interrupted while it replaced the files in " + folder +
                              ", which must be completed first: correct the permissions of this file and its folder, "
                              "and repeat the command");
      }
      std::error_code error;
      if (::rename(work.c_str(), aside.c_str()) == 0) fs::remove_all(aside, error);
      flush_to_disk(folder);
      return;
    }
    if (::rmdir(work.c_str()) == 0) return;  // empty: its content was lost in a crash of the system
    throw_if_interrupted();
    if (std::chrono::steady_clock::now() > end) {
      throw OutputError(folder,
                        "another command is replacing the files of this folder: " + describe_writer(work.string()) +
                            "; repeat the command when that one has finished or, if it was interrupted, repeat "
                            "it on that host");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace gladstone::inline files
