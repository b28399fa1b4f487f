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

#include "render/files/hdf5_file.h"

/// Helpers shared by the files that call the HDF5 C library, hdf5_reader.cpp, hdf5_reader_handle.cpp, hdf5_writer.cpp,
/// hdf5_content.cpp, hdf5_objects.cpp and hdf5_handle.cpp; not for other files.
namespace gladstone::inline files::hdf5 {

/// Global lock around all HDF5 calls, since Debian's HDF5 library is not thread-safe.
inline std::recursive_mutex& library_lock() {
  static std::recursive_mutex lock;
  return lock;
}
using Lock = std::lock_guard<std::recursive_mutex>;

/// RAII owner of an HDF5 identifier (hid_t).
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

/// Splits a path: "/a/b/c" gives {"a", "b", "c"}.
inline std::vector<std::string> steps(std::string const& path) {
  std::vector<std::string> parts;
  for (auto const& part : std::filesystem::path(path)) {
    if (part != "/" && !part.empty()) parts.push_back(part.string());
  }
  return parts;
}

/// Writes the attributes of Hdf5Writer::attach_scales() to an open file. @return false if HDF5 fails
bool attach_scales(std::int64_t file, std::vector<ScaledDataset> const& datasets);

}  // namespace gladstone::inline files::hdf5
