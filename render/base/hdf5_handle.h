#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

/// What the two files that call the HDF5 C library share (hdf5_reader.cpp, hdf5_writer.cpp); nothing else includes it.
namespace gladstone::hdf5 {

/// Debian's HDF5 is not thread-safe: one call at a time in the whole program.
inline std::recursive_mutex& library_lock() {
  static std::recursive_mutex lock;
  return lock;
}
using Lock = std::lock_guard<std::recursive_mutex>;

/// An HDF5 identifier (hid_t) that closes itself.
class Id {
 public:
  Id(std::int64_t id, int (*close)(std::int64_t)) : id_(id), close_(close) {}
  ~Id() { reset(); }
  Id(Id&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = invalid; }
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  operator std::int64_t() const { return id_; }
  bool valid() const { return id_ >= 0; }
  void reset() {
    if (valid()) close_(id_);
    id_ = invalid;
  }

 private:
  static constexpr std::int64_t invalid = -1;

  std::int64_t id_;
  int (*close_)(std::int64_t);
};

inline std::size_t product(std::vector<std::size_t> const& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

/// "/a/b/c" to {"a", "b", "c"}
inline std::vector<std::string> steps(std::string const& path) {
  std::vector<std::string> parts;
  for (auto const& part : std::filesystem::path(path)) {
    if (part != "/" && !part.empty()) parts.push_back(part.string());
  }
  return parts;
}

}  // namespace gladstone::hdf5
