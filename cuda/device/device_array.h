#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "cuda/device/device_memory.h"

namespace gladstone::cuda::inline device {

/// RAII array in device memory, allocated from the memory pool in the order of the default stream.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  /// Allocates an uninitialised array. @param what_for  named in the error message
  /// @throws OutOfDeviceMemory
  DeviceArray(std::size_t size, std::string const& what_for) : size_(size) {
    if (size > 0) data_ = static_cast<T*>(allocate_on_device(size * sizeof(T), what_for));
  }
  DeviceArray(T const* host, std::size_t size, std::string const& what_for) : DeviceArray(size, what_for) {
    upload(host);
  }
  DeviceArray(DeviceArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  DeviceArray(DeviceArray const&) = delete;
  DeviceArray& operator=(DeviceArray const&) = delete;
  ~DeviceArray() { release_on_device(data_, size_ * sizeof(T)); }

  T* data() { return data_; }
  T const* data() const { return data_; }
  std::size_t size() const { return size_; }

  /// Copies size() elements from `host`.
  void upload(T const* host) {
    if (size_ > 0) copy_to_device(data_, host, size_ * sizeof(T));
  }
  /// Copies the first `count` elements to `host`, after all preceding work.
  void download(T* host, std::size_t count) const {
    if (count > 0) copy_to_host(host, data_, count * sizeof(T));
  }
  void zero() {
    if (size_ > 0) zero_on_device(data_, size_ * sizeof(T));
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Page-locked host memory that grows on demand and never shrinks.
class PinnedBuffer {
 public:
  PinnedBuffer() = default;
  PinnedBuffer(PinnedBuffer const&) = delete;
  PinnedBuffer& operator=(PinnedBuffer const&) = delete;
  ~PinnedBuffer() { release_pinned(data_); }
  /// Returns memory for at least `bytes` bytes; previous contents are lost.
  void* reserve(std::size_t bytes) {
    if (bytes > bytes_) {
      bytes_ = 0;
      release_pinned(std::exchange(data_, nullptr));
      data_ = allocate_pinned(bytes);
      bytes_ = bytes;
    }
    return data_;
  }

 private:
  void* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace gladstone::cuda::inline device
