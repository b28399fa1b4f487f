#pragma once

#include <cstddef>
#include <string>

namespace gladstone {

/// Who computes which case: byte INDEX of the file RUN/claims is locked (file_lock.h) while a process works on case
/// INDEX.
class Claims {
 public:
  enum class Use {
    take,  ///< RUN/claims is made where it is missing
    look   ///< nothing is written; without RUN/claims no case is held
  };
  /// Opens RUN/claims. @throws OutputError, where RUN is read-only and claims are to be taken too
  Claims(std::string const& run, Use use);
  ~Claims();
  Claims(Claims const&) = delete;
  Claims& operator=(Claims const&) = delete;

  /// Takes a case for this object; false where another has it. Where RUN/claims has been replaced or removed since, the
  /// new one is locked, which others look at too. @pre made to take
  /// @throws OutputError where the file system has no locks
  bool take(std::size_t index);
  void release(std::size_t index);

  /// Whether another holds this case, or any.
  bool held(std::size_t index) const;
  bool any_held() const;

 private:
  bool lock(std::size_t index);
  bool is_replaced() const;  ///< RUN/claims is another file than the one that was opened
  bool held_from(std::size_t first, std::size_t count) const;

  std::string path_;
  int file_ = -1;  ///< -1: not there, and only looked for
};

}  // namespace gladstone
