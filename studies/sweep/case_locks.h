#pragma once

#include <cstddef>
#include <string>

namespace gladstone::inline sweep {

/// Locks on cases, one per case, held by the processes that compute them: byte INDEX of the file RUN/claims is locked
/// (file_lock.h) while a process works on case INDEX.
class CaseLocks {
 public:
  enum class Use {
    take,  ///< mode for claiming cases; creates RUN/claims if it is missing
    look   ///< read-only; if RUN/claims is missing, no case is claimed
  };
  /// Opens RUN/claims. @throws OutputError if it cannot be opened, for example because RUN is read-only and Use is
  /// `take`
  CaseLocks(std::string const& run, Use use);
  ~CaseLocks();
  CaseLocks(CaseLocks const&) = delete;
  CaseLocks& operator=(CaseLocks const&) = delete;

  /// Locks a case for this object. If RUN/claims has been replaced or removed since it was opened, the new file is
  /// opened and locked, since other processes use that one.
  /// @return false if another process has claimed the case
  /// @pre opened with Use::take
  /// @throws OutputError if the file system does not support locks
  bool take(std::size_t index);
  void release(std::size_t index);

  /// Returns true if another process has claimed this case, or any case.
  bool held(std::size_t index) const;
  bool any_held() const;

 private:
  bool lock(std::size_t index);
  bool held_from(std::size_t first, std::size_t count) const;

  std::string path_;
  int file_ = -1;  ///< descriptor of the file; -1: the file does not exist and Use is `look`
};

}  // namespace gladstone::inline sweep
