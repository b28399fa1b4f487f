#include "render/files/input_guard.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "render/base/error.h"
#include "render/files/folder_replacement.h"
#include "render/files/output_destination.h"

namespace gladstone::inline files {
namespace {

using FileId = std::pair<dev_t, ino_t>;

struct Record {
  std::mutex mutex;
  int guards = 0;
  std::map<FileId, std::string> inputs;  ///< name by which each input was opened, by file identity
  std::set<FileId> outputs;
  std::vector<ProtectedFiles> results;
};

Record& record() {
  static Record all;
  return all;
}

thread_local int unguarded = 0;
thread_local int writing_protected = 0;

FileId file_id(struct stat const& file) { return {file.st_dev, file.st_ino}; }

}  // namespace

InputGuard::InputGuard(std::vector<ProtectedFiles> results) {
  std::lock_guard const lock(record().mutex);
  ++record().guards;
  record().results = std::move(results);
}

InputGuard::~InputGuard() {
  std::lock_guard const lock(record().mutex);
  if (--record().guards > 0) return;
  record().inputs.clear();
  record().outputs.clear();
  record().results.clear();
}

UnrecordedReading::UnrecordedReading() { ++unguarded; }
UnrecordedReading::~UnrecordedReading() { --unguarded; }

ProtectedWritePermit::ProtectedWritePermit() { ++writing_protected; }
ProtectedWritePermit::~ProtectedWritePermit() { --writing_protected; }

void record_input(std::string const& path, struct stat const& file) {
  if (unguarded > 0) return;
  std::lock_guard const lock(record().mutex);
  if (record().guards == 0 || record().outputs.contains(file_id(file))) return;
  record().inputs.emplace(file_id(file), path);
}

void record_output(int descriptor) {
  struct stat file {};
  if (::fstat(descriptor, &file) != 0) return;
  std::lock_guard const lock(record().mutex);
  if (record().guards == 0) return;
  record().inputs.erase(file_id(file));  // the inode number of a removed input may be reused
  record().outputs.insert(file_id(file));
}

void refuse_recorded_input(std::string const& path, std::string const& asked) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return;
  std::lock_guard const lock(record().mutex);
  auto const input = record().inputs.find(file_id(file));
  if (input == record().inputs.end()) return;
  refuse_overwriting(input->second, asked);
}

void refuse_protected_file(std::string const& path, std::string const& asked) {
  namespace fs = std::filesystem;
  if (writing_protected > 0) return;
  std::lock_guard const lock(record().mutex);
  fs::path folder = path;
  for (int level = 0; level < 2; ++level) {
    folder = folder.parent_path();
    std::string const name = fs::path(path).lexically_relative(folder).string();
    for (ProtectedFiles const& files : record().results) {
      std::error_code error;
      bool const is_there = std::all_of(files.markers.begin(), files.markers.end(),
                                        [&](std::string const& marker) { return fs::exists(folder / marker, error); });
      if (!is_there || !is_derived(name, FolderContent{{}, files.names})) continue;
      throw OutputError(asked, "belongs to the " + files.what + " in " + folder.string() +
                                   ", and is not written by this command; choose another output");
    }
  }
}

}  // namespace gladstone::inline files
