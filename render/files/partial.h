#pragma once

#include <functional>
#include <optional>
#include <string>

namespace gladstone::inline files {

/// Incomplete output: a hidden file or directory whose name identifies the writing process (host, boot, disk, process
/// id and a random number), locked (file_lock.h) while the process runs. A directory contains the lock in a file
/// "lock-WRITER". Two writers never share one.
class Partial {
 public:
  enum class Kind { file, folder };

  /// Creates and locks PARENT/STEMpartial-WRITER; the stem ".case." gives ".case.partial-WRITER".
  /// @throws std::system_error if it cannot be created
  Partial(std::string const& parent, std::string const& stem, Kind kind);
  /// Removes the file or directory unless keep() was called.
  ~Partial();
  Partial(Partial const&) = delete;
  Partial& operator=(Partial const&) = delete;

  std::string const& path() const { return path_; }
  /// File descriptor: of the file, open for reading and writing, or of a directory's lock file.
  int descriptor() const { return descriptor_; }
  /// Renames the file or directory, replacing what exists at the path. @return 0, or errno with nothing changed
  int move_to(std::string const& path);
  /// Completes the output: releases the lock and disables the removal on destruction.
  void keep();

 private:
  std::string path_;
  int descriptor_ = -1;
};

/// Incomplete output of a process that ended, locked by this process for completion or removal.
class AbandonedOutput {
 public:
  /// Locks an incomplete output if its writer has ended, else returns nullopt. The lock shows whether a writer of this
  /// boot and disk is running. A writer of an earlier boot of this host has ended. For other hosts, and for writers
  /// without locks, this cannot be determined, and nullopt is returned.
  /// @param path  path of a partial output, or of a directory renamed by Partial::move_to()
  static std::optional<AbandonedOutput> take(std::string const& path);
  ~AbandonedOutput();
  AbandonedOutput(AbandonedOutput&& other) noexcept;
  AbandonedOutput& operator=(AbandonedOutput&&) = delete;

  /// Returns the name that the same writer would give to a partial output with another stem.
  std::string name(std::string const& stem) const;

 private:
  AbandonedOutput(int lock, std::string writer) : lock_(lock), writer_(std::move(writer)) {}
  int lock_;
  std::string writer_;
};

/// Describes the writer of a partial directory: "process 4711 on host lab3".
std::string describe_writer(std::string const& folder);

/// Removes the partial outputs of a stem in a directory whose writers have ended.
void remove_abandoned_outputs(std::string const& parent, std::string const& stem);

/// Removes the partial outputs of all stems in a directory that belongs to gladstone, if their writers have ended.
void remove_abandoned_outputs(std::string const& folder);

/// Returns the stem of temporary names next to a file or directory: ".NAME.", shortened (with a hash of the name) if
/// the file system's limit of 255 bytes would be exceeded.
std::string sibling_stem(std::string const& name);

/// Returns true if a directory entry's name is that of a partial output with this stem, of any writer.
bool is_partial(std::string const& name, std::string const& stem);

/// Calls `write`; an OutputError about a path below `staged` is rethrown about the same path below `place`.
void report_final_path(std::string const& staged, std::string const& place, std::function<void()> const& write);

}  // namespace gladstone::inline files
