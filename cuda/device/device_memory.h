#pragma once

#include <atomic>
#include <cstddef>
#include <limits>
#include <string>

#include "render/base/error.h"

/// Device memory: allocation, accounting and transfers. Does not include CUDA headers, so that tests and benchmarks
/// outside of cuda/ can use it.
namespace gladstone::cuda::inline device {

/// Device memory held by the arrays of this process, its maximum, and its limit [bytes]. Tests set the limit and read
/// the maximum.
struct DeviceMemoryAccount {
  std::atomic<std::size_t> held{0};
  std::atomic<std::size_t> most_held{0};
  std::atomic<std::size_t> limit{std::numeric_limits<std::size_t>::max()};
};
inline DeviceMemoryAccount device_memory_account;

/// Upper limit of the shared memory per block, in addition to that of the device [bytes]. Set by tests.
inline std::atomic<std::size_t> shared_memory_limit{std::numeric_limits<std::size_t>::max()};

/// Free and total memory [bytes].
struct DeviceMemoryInfo {
  std::size_t free;
  std::size_t total;
};

/// Returns the memory available to arrays, including unused memory in the pool. Waits for the default stream.
/// @throws DeviceError
DeviceMemoryInfo query_device_memory();

/// Thrown if an allocation fails for lack of device memory: callers may retry with a smaller one. what() reports the
/// sizes.
class OutOfDeviceMemory : public DeviceMemoryError {
 public:
  OutOfDeviceMemory(std::string const& what_for, std::size_t bytes);
};

/// Configures the pool to retain freed device memory for this process, which avoids driver calls in later renderings.
void keep_freed_device_memory();

/// Allocates uninitialised memory from the device's pool, in the order of the default stream.
/// @param what_for  named in the error message
/// @throws OutOfDeviceMemory, DeviceError
void* allocate_on_device(std::size_t bytes, std::string const& what_for);

/// Releases memory from allocate_on_device(). @param bytes  size of the allocation
void release_on_device(void* memory, std::size_t bytes) noexcept;

/// Copies or zeroes memory in the order of the default stream; copies to the host wait for preceding work.
/// @throws DeviceError
void copy_to_device(void* to, void const* from, std::size_t bytes);
/// Copies asynchronously. @param from  page-locked memory, which must remain unchanged until the copy has finished
void copy_pinned_to_device(void* to, void const* from, std::size_t bytes);
void copy_to_host(void* to, void const* from, std::size_t bytes);
void zero_on_device(void* memory, std::size_t bytes);
/// Waits for all work on the device. @throws DeviceError
void wait_for_device();

/// Allocates page-locked host memory, to and from which a device transfers at full speed. @throws DeviceError
void* allocate_pinned(std::size_t bytes);
void release_pinned(void* memory) noexcept;

}  // namespace gladstone::cuda::inline device
