#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace gladstone {

/// SHA-256 (FIPS 180-4) of bytes given piece by piece: what results name the files by that they were made from. Where
/// telling contents apart is enough, content_hash() is faster and shorter.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void add(void const* bytes, std::size_t size);
  void add(std::string_view bytes) { add(bytes.data(), bytes.size()); }
  /// Of everything so far, 64 hexadecimal digits; nothing may be added after it.
  std::string finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

}  // namespace gladstone
