#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "cuda/device/device_memory.h"

namespace gladstone::cuda {

/// RAII guard that limits further allocations to `bytes`, as on a smaller card. At most one may exist.
class DeviceMemoryLimit {
 public:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  explicit DeviceMemoryLimit(std::size_t bytes) : held_before_(device_memory_account.held) {
    device_memory_account.most_held = held_before_;
    device_memory_account.limit = std::min(bytes, none - held_before_) + held_before_;
  }
  ~DeviceMemoryLimit() { device_memory_account.limit = none; }
  DeviceMemoryLimit(DeviceMemoryLimit const&) = delete;
  DeviceMemoryLimit& operator=(DeviceMemoryLimit const&) = delete;

  /// Maximum memory held since construction, minus that held before [bytes].
  std::size_t most_held() const { return device_memory_account.most_held - held_before_; }

 private:
  std::size_t held_before_;
};

/// RAII guard that limits the shared memory per block to `bytes`, as on a smaller card. At most one may exist.
class SharedMemoryLimit {
 public:
  explicit SharedMemoryLimit(std::size_t bytes) { shared_memory_limit = bytes; }
  ~SharedMemoryLimit() { shared_memory_limit = std::numeric_limits<std::size_t>::max(); }
  SharedMemoryLimit(SharedMemoryLimit const&) = delete;
  SharedMemoryLimit& operator=(SharedMemoryLimit const&) = delete;
};

}  // namespace gladstone::cuda
