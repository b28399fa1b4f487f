#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace gladstone::inline files {

/// Incremental SHA-256 hash (FIPS 180-4). Results identify their input files by it; where detecting changes is
/// sufficient, content_hash() is faster and shorter.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(void const* bytes, std::size_t size);
  void add(std::string_view bytes) { add(bytes.data(), bytes.size()); }
  /// Returns the hash of all bytes added, as 64 hexadecimal digits; nothing may be added afterwards.
  std::string finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace gladstone::inline files
