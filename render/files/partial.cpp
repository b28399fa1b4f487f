#include "render/files/partial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/files/content_hash.h"
#include "render/files/file_lock.h"

namespace gladstone::inline files {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view label = "partial-";
constexpr std::string_view lock_label = "lock-";
// replaces the boot id for writers without a lock, whose end cannot be detected
constexpr char const* without_lock = "unlocked";

std::string this_host() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  std::string host(name);
  for (char& c : host) {
    bool const plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.';
    if (!plain) c = '_';
  }
  return host.substr(0, 64);
}

/// Returns a hash of the system's boot id, which is the same in all containers of a host; empty if the system has none.
std::string const& this_boot() {
  static std::string const boot = [] {
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    return id.empty() ? "" : content_hash(id);
  }();
  return boot;
}

/// Returns the time of the system start [s since 1970].
time_t boot_time() {
  timespec now{}, since_boot{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  ::clock_gettime(CLOCK_BOOTTIME, &since_boot);
  return now.tv_sec - since_boot.tv_sec;
}

/// Identification of a writer, "HOST-BOOT-DEVICE-PROCESS-RANDOM".
struct Writer {
  std::string host, boot, device, process;

  static std::optional<Writer> of(std::string const& text) {
    std::array<std::string, 5> parts;
    std::size_t begin = 0;
    for (std::string& part : parts) {
      if (begin > text.size()) return std::nullopt;
      std::size_t const end = std::min(text.find('-', begin), text.size());
      part = text.substr(begin, end - begin);
      if (part.empty()) return std::nullopt;
      begin = end + 1;
    }
    if (begin <= text.size()) return std::nullopt;
    return Writer{parts[0], parts[1], parts[2], parts[3]};
  }

  /// Returns true if a released lock proves that the writer has ended.
  /// @param disk     device number of the file system
  /// @param touched  time of the last change of its partial output
  bool can_be_judged(dev_t disk, time_t touched) const {
    std::string const& now = this_boot();
    if (now.empty() || boot == without_lock) return false;
    if (boot == now) return device == fmt::format("{:x}", disk);
    return host == this_host() && touched < boot_time();
  }
};

std::string new_writer(dev_t disk, bool locked) {
  std::uint32_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number) number = static_cast<std::uint32_t>(::clock());
  std::string const boot = locked ? this_boot() : "";
  return this_host() + '-' + (boot.empty() ? without_lock : boot) + '-' + fmt::format("{:x}", disk) + '-' +
         std::to_string(::getpid()) + '-' + fmt::format("{:x}", number);
}

/// Returns the writer part of a partial output's name, or of the name of the lock file in a directory.
std::string writer_text(fs::path const& path) {
  std::error_code error;
  for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
    std::string const name = entry->path().filename().string();
    if (name.starts_with(lock_label)) return name.substr(lock_label.size());
  }
  std::string const name = path.filename().string();
  std::size_t const at = name.rfind(label);
  return at == std::string::npos ? "" : name.substr(at + label.size());
}

}  // namespace

Partial::Partial(std::string const& parent, std::string const& stem, Kind kind) {
  struct stat disk {};
  if (::stat(parent.c_str(), &disk) != 0) throw std::system_error(errno, std::generic_category());
  bool locked = true;
  // Repeat until the name is unused and no other process has removed the output before it was locked.
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::string const writer = new_writer(disk.st_dev, locked);
    path_ = (fs::path(parent) / std::string(stem).append(label).append(writer)).string();
    std::string lock = path_;
    if (kind == Kind::folder) {
      if (::mkdir(path_.c_str(), 0777) != 0) {
        if (errno == EEXIST) continue;
        throw std::system_error(errno, std::generic_category());
      }
      lock += '/' + std::string(lock_label) + writer;
    }
    descriptor_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | (kind == Kind::file ? O_EXCL : 0), 0666);
    if (descriptor_ < 0) {
      int const error = errno;
      if (kind == Kind::folder) ::rmdir(path_.c_str());
      if (error == EEXIST || (error == ENOENT && kind == Kind::folder)) continue;
      throw std::system_error(error, std::generic_category());
    }
    int const error = locked ? lock_bytes(descriptor_, 0, 0) : 0;
    if (error == 0 && leads_to(lock, descriptor_)) return;
    ::close(std::exchange(descriptor_, -1));
    // another process has mistaken it for an abandoned output and removed it
    if (error == EAGAIN || error == 0) continue;
    locked = false;
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  throw std::system_error(EBUSY, std::generic_category());
}

Partial::~Partial() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(descriptor_);
}

int Partial::move_to(std::string const& path) {
  if (::rename(path_.c_str(), path.c_str()) != 0) return errno;
  path_ = path;
  return 0;
}

void Partial::keep() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

std::optional<AbandonedOutput> AbandonedOutput::take(std::string const& path) {
  struct stat found {};
  struct stat disk {};
  if (::lstat(path.c_str(), &found) != 0) return std::nullopt;
  bool const folder = S_ISDIR(found.st_mode);
  if (!folder && !S_ISREG(found.st_mode)) return std::nullopt;
  std::string const text = writer_text(path);
  std::optional<Writer> const writer = Writer::of(text);
  if (!writer || ::stat(fs::path(path).parent_path().c_str(), &disk) != 0) return std::nullopt;
  std::string const lock = folder ? path + '/' + std::string(lock_label) + text : path;
  struct stat touched = found;
  bool const has_lock = ::lstat(lock.c_str(), &touched) == 0;
  if (!writer->can_be_judged(disk.st_dev, has_lock ? touched.st_mtime : found.st_mtime)) return std::nullopt;
  int const file = ::open(lock.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | (folder ? O_CREAT : 0), 0666);
  if (file < 0) return std::nullopt;
  AbandonedOutput taken(file, text);
  if (lock_bytes(file, 0, 0) != 0 || !leads_to(lock, file)) return std::nullopt;
  return taken;
}

AbandonedOutput::~AbandonedOutput() {
  if (lock_ >= 0) ::close(lock_);
}
AbandonedOutput::AbandonedOutput(AbandonedOutput&& other) noexcept
    : lock_(std::exchange(other.lock_, -1)), writer_(std::move(other.writer_)) {}

std::string AbandonedOutput::name(std::string const& stem) const { return stem + std::string(label) + writer_; }

std::string describe_writer(std::string const& folder) {
  std::optional<Writer> const writer = Writer::of(writer_text(folder));
  return writer ? "process " + writer->process + " on host " + writer->host : "another process";
}

namespace {

/// Removes the entries of a directory that `chosen` selects by their name and whose writers have ended.
template <class Chosen>
void remove_dead(std::string const& folder, Chosen const& chosen) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (chosen(entry->path().filename().string())) found.push_back(entry->path());
  }
  for (fs::path const& path : found) {
    if (auto const taken = AbandonedOutput::take(path.string())) fs::remove_all(path, error);
  }
}

}  // namespace

void remove_abandoned_outputs(std::string const& parent, std::string const& stem) {
  remove_dead(parent, [&](std::string const& name) { return is_partial(name, stem); });
}

void remove_abandoned_outputs(std::string const& folder) {
  remove_dead(folder, [](std::string const& name) {
    return name.starts_with('.') && name.find('.' + std::string(label)) != std::string::npos;
  });
}

std::string sibling_stem(std::string const& name) {
  constexpr std::size_t longest = 120;  // 255 bytes minus up to 130 for the identification of the writer
  if (name.size() <= longest) return '.' + name + '.';
  std::size_t cut = longest - 17;
  // do not cut within a UTF-8 character
  while (cut > 0 && (static_cast<unsigned char>(name[cut]) & 0xc0) == 0x80) --cut;
  return '.' + name.substr(0, cut) + '-' + content_hash(name) + '.';
}

bool is_partial(std::string const& name, std::string const& stem) {
  return name.starts_with(stem) && std::string_view(name).substr(stem.size()).starts_with(label);
}

void report_final_path(std::string const& staged, std::string const& place, std::function<void()> const& write) try {
  write();
} catch (OutputError const& error) {
  if (!error.place().starts_with(staged)) throw;
  throw OutputError(place + error.place().substr(staged.size()), error.message());
}

}  // namespace gladstone::inline files
