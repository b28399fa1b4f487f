#include "render/base/input_guard.h"

#include <sys/stat.h>

#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "render/base/error.h"

namespace gladstone {
namespace {

using FileId = std::pair<dev_t, ino_t>;

struct Record {
  std::mutex mutex;
  int guards = 0;
  std::map<FileId, std::string> inputs;  ///< name by which each input was opened
  std::set<FileId> outputs;
};

Record& record() {
  static Record all;
  return all;
}

thread_local int unguarded = 0;

FileId id_of(struct stat const& file) { return {file.st_dev, file.st_ino}; }

}  // namespace

InputGuard::InputGuard() {
  std::lock_guard const lock(record().mutex);
  ++record().guards;
}

InputGuard::~InputGuard() {
  std::lock_guard const lock(record().mutex);
  if (--record().guards > 0) return;
  record().inputs.clear();
  record().outputs.clear();
}

UnguardedReading::UnguardedReading() { ++unguarded; }
UnguardedReading::~UnguardedReading() { --unguarded; }

void record_input(std::string const& path, struct stat const& file) {
  if (unguarded > 0) return;
  std::lock_guard const lock(record().mutex);
  if (record().guards == 0 || record().outputs.contains(id_of(file))) return;
  record().inputs.emplace(id_of(file), path);
}

void record_output(int descriptor) {
  struct stat file {};
  if (::fstat(descriptor, &file) != 0) return;
  std::lock_guard const lock(record().mutex);
  if (record().guards == 0) return;
  record().inputs.erase(id_of(file));  // the inode number of a removed input may be reused
  record().outputs.insert(id_of(file));
}

void refuse_recorded_input(std::string const& path, std::string const& asked) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return;
  std::lock_guard const lock(record().mutex);
  auto const input = record().inputs.find(id_of(file));
  if (input == record().inputs.end()) return;
  throw OutputError(asked, "would be overwritten, and is read by this command" +
                               (asked == input->second ? std::string() : " (as " + input->second + ')') +
                               "; choose another output");
}

}  // namespace gladstone
