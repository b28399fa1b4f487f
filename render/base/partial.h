#pragma once

#include <functional>
#include <optional>
#include <string>

namespace gladstone {

/// Where output stands until it is whole: a hidden file or folder named after who writes it (host, boot of its system,
/// disk, process, and a random number), and locked (file_lock.h) as long as the writer lives. A folder holds the lock
/// in a file of its own, "lock-" and the writer. Two writers never share one.
class Partial {
 public:
  enum class Kind { file, folder };

  /// Makes PARENT/STEMpartial-WRITER; ".case." as stem gives ".case.partial-WRITER".
  /// @throws std::system_error where it cannot be made
  Partial(std::string const& parent, std::string const& stem, Kind kind);
  /// Removes what still stands there.
  ~Partial();
  Partial(Partial const&) = delete;
  Partial& operator=(Partial const&) = delete;

  std::string const& path() const { return path_; }
  /// Of Kind::file, open for reading and writing; of a folder its lock.
  int descriptor() const { return descriptor_; }
  /// Renames it over what may stand at a path. @return 0 or errno, with nothing changed
  int move_to(std::string const& path);
  /// It has become what it was to be: the lock is given back and nothing is removed.
  void keep();

 private:
  std::string path_;
  int descriptor_ = -1;
};

/// A partial file or folder that a dead writer left, locked for who completes it or clears it away.
class Leftover {
 public:
  /// Nothing where its writer lives, or where that cannot be told: locks tell it for writers of this very system and
  /// disk. Whoever wrote before this host's system was started is dead too; other hosts' partials are left alone.
  /// @param path of a partial, or of a folder that Partial::move_to has moved
  static std::optional<Leftover> take(std::string const& path);
  ~Leftover();
  Leftover(Leftover&& other) noexcept;
  Leftover& operator=(Leftover&&) = delete;

  /// The name that its writer gave it, with another stem.
  std::string name(std::string const& stem) const;

 private:
  Leftover(int lock, std::string writer) : lock_(lock), writer_(std::move(writer)) {}
  int lock_;
  std::string writer_;
};

/// Who writes, or wrote, into a partial folder: "process 4711 on host lab3".
std::string writer_of(std::string const& folder);

/// Removes the partials with this stem in a folder whose writers are dead.
void remove_leftovers(std::string const& parent, std::string const& stem);

/// The same of every stem; for folders that are gladstone's own.
void remove_leftovers(std::string const& folder);

/// The stem of what belongs to a name beside it: ".NAME.", shortened where the file system's limit on names would be
/// exceeded.
std::string stem_beside(std::string const& name);

/// Whether a name in a folder is that of a partial of ours with this stem, whoever writes it.
bool is_partial(std::string const& name, std::string const& stem);

/// Calls `write`; where it throws an OutputError about something in `staged`, throws it about the same in `place`.
void name_final_place(std::string const& staged, std::string const& place, std::function<void()> const& write);

}  // namespace gladstone
