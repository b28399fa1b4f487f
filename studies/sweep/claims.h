#pragma once

#include <cstddef>
#include <string>

namespace gladstone {

/// Who computes which case: byte INDEX of the file RUN/claims is locked while a process works on case INDEX. The locks
/// belong to the open file (F_OFD_SETLK): they go with the process, however it ends, hold between machines over NFS,
/// and leave nothing behind that could grow stale.
class Claims {
 public:
  /// Opens RUN/claims, making it where it is missing. @throws OutputError
  explicit Claims(std::string const& run);
  ~Claims();
  Claims(Claims const&) = delete;
  Claims& operator=(Claims const&) = delete;

  /// Takes a case for this object; false where another has it. @throws OutputError where the file system has no locks
  bool take(std::size_t index);
  void release(std::size_t index);

  /// Whether another holds this case, or any.
  bool held(std::size_t index) const;
  bool any_held() const;

 private:
  bool held_from(std::size_t first, std::size_t count) const;

  std::string path_;
  int file_ = -1;
};

}  // namespace gladstone
