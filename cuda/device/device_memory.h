#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

#include "render/base/error.h"

/// The device's memory: who takes how much of it, and what goes there and back. No CUDA header here, so that tests and
/// benchmarks, which lie outside of cuda/, can use it.
namespace gladstone::cuda {

/// What the arrays of this process hold on the device, and may hold [bytes].
struct DeviceMemoryAccount {
  std::atomic<std::size_t> held{0};
  std::atomic<std::size_t> most_held{0};
  std::atomic<std::size_t> limit{std::numeric_limits<std::size_t>::max()};
};
inline DeviceMemoryAccount device_memory_account;

/// While it lives, arrays get no more than `bytes` beyond what they hold now, as on a smaller card; for tests of what
/// happens then. One at a time.
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

  /// The most that was held at a time since then, beyond what was before [bytes].
  std::size_t most_held() const { return device_memory_account.most_held - held_before_; }

 private:
  std::size_t held_before_;
};

/// Shared memory that a block gets at most, where the device offers more [bytes].
inline std::atomic<std::size_t> shared_memory_limit{std::numeric_limits<std::size_t>::max()};

/// While it lives, blocks get no more shared memory than `bytes`, as on a smaller card; for tests. One at a time.
class SharedMemoryLimit {
 public:
  explicit SharedMemoryLimit(std::size_t bytes) { shared_memory_limit = bytes; }
  ~SharedMemoryLimit() { shared_memory_limit = std::numeric_limits<std::size_t>::max(); }
  SharedMemoryLimit(SharedMemoryLimit const&) = delete;
  SharedMemoryLimit& operator=(SharedMemoryLimit const&) = delete;
};

/// [bytes]
struct DeviceRoom {
  std::size_t free;
  std::size_t total;
};

/// What arrays can still get, memory that the pool keeps for them included. Waits for the default stream.
/// @throws DeviceError
DeviceRoom device_room();

/// The device has no room left: callers may try again with less. what() names the sizes.
class OutOfDeviceMemory : public DeviceError {
 public:
  OutOfDeviceMemory(std::string const& what_for, std::size_t bytes);
};

/// Freed memory of the device stays with the process, so that the next rendering does not wait for the driver.
void keep_freed_device_memory();

/// Memory from the device's pool, in the order of the default stream; contents are undefined.
/// @param what_for named in the message should memory be short @throws OutOfDeviceMemory, DeviceError
void* allocate_on_device(std::size_t bytes, std::string const& what_for);

/// Gives it back. @param bytes as allocated
void release_on_device(void* memory, std::size_t bytes) noexcept;

/// Copies, and zeroes, in the order of the default stream; copies to the host wait for the work before them.
/// @throws DeviceError
void copy_to_device(void* to, void const* from, std::size_t bytes);
/// Does not wait. @param from page-locked, to stay as it is until the work after it is done
void copy_pinned_to_device(void* to, void const* from, std::size_t bytes);
void copy_to_host(void* to, void const* from, std::size_t bytes);
void zero_on_device(void* memory, std::size_t bytes);

/// Page-locked memory of the host, which a device copies to at full speed. @throws DeviceError
void* allocate_pinned(std::size_t bytes);
void release_pinned(void* memory) noexcept;

}  // namespace gladstone::cuda
