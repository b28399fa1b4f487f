#include "cuda/device/device_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "cuda/device/cuda_error.h"

namespace gladstone::cuda::inline device {
namespace {

/// Registers an allocation. @return false if it would exceed the limit
bool enter(std::size_t bytes) {
  DeviceMemoryAccount& account = device_memory_account;
  std::size_t held = account.held;
  do {
    std::size_t const limit = account.limit;
    if (held > limit || bytes > limit - held) return false;
  } while (!account.held.compare_exchange_weak(held, held + bytes));
  std::size_t most = account.most_held;
  while (most < held + bytes && !account.most_held.compare_exchange_weak(most, held + bytes)) {
  }
  return true;
}

std::size_t pool_attribute(cudaMemPool_t pool, cudaMemPoolAttr attribute) {
  std::uint64_t value = 0;
  check(cudaMemPoolGetAttribute(pool, attribute, &value), "cudaMemPoolGetAttribute");
  return value;
}

/// Formats bytes in MiB, with decimals for small sizes.
std::string mebibytes(std::size_t bytes) {
  double const size = static_cast<double>(bytes) / 0x1p20;
  return fmt::format("{:.{}f}", size, size < 10 ? 3 : 0);
}

std::string shortage(std::string const& what_for, std::size_t bytes) {
  DeviceMemoryInfo const room = query_device_memory();
  return fmt::format(
      "out of device memory: {} needs {} MiB, {} of {} MiB are free; use fewer rays, smaller images or volumes, or "
      "--device cpu",
      what_for, mebibytes(bytes), mebibytes(room.free), mebibytes(room.total));
}

}  // namespace

OutOfDeviceMemory::OutOfDeviceMemory(std::string const& what_for, std::size_t bytes)
    : DeviceMemoryError(shortage(what_for, bytes)) {}

DeviceMemoryInfo query_device_memory() {
  check(cudaStreamSynchronize(nullptr), "cudaStreamSynchronize");  // memory is released in stream order
  DeviceMemoryInfo room{};
  check(cudaMemGetInfo(&room.free, &room.total), "cudaMemGetInfo");
  int device = 0;
  check(cudaGetDevice(&device), "cudaGetDevice");
  cudaMemPool_t pool = nullptr;
  check(cudaDeviceGetDefaultMemPool(&pool, device), "cudaDeviceGetDefaultMemPool");
  room.free +=
      pool_attribute(pool, cudaMemPoolAttrReservedMemCurrent) - pool_attribute(pool, cudaMemPoolAttrUsedMemCurrent);
  std::size_t const limit = device_memory_account.limit, held = device_memory_account.held;
  return {std::min(room.free, limit - std::min(held, limit)), std::min(room.total, limit)};
}

void keep_freed_device_memory() {
  int device = 0;
  check(cudaGetDevice(&device), "cudaGetDevice");
  cudaMemPool_t pool = nullptr;
  check(cudaDeviceGetDefaultMemPool(&pool, device), "cudaDeviceGetDefaultMemPool");
  std::uint64_t all = ~std::uint64_t{0};
  check(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &all), "cudaMemPoolSetAttribute");
}

void* allocate_on_device(std::size_t bytes, std::string const& what_for) {
  if (!enter(bytes)) throw OutOfDeviceMemory(what_for, bytes);
  void* memory = nullptr;
  cudaError_t const status = cudaMallocAsync(&memory, bytes, nullptr);
  if (status == cudaSuccess) return memory;
  device_memory_account.held -= bytes;
  if (status != cudaErrorMemoryAllocation) check(status, "cudaMallocAsync");
  cudaGetLastError();  // the error is not sticky; clear it
  throw OutOfDeviceMemory(what_for, bytes);
}

void release_on_device(void* memory, std::size_t bytes) noexcept {
  if (!memory) return;
  cudaFreeAsync(memory, nullptr);  // fails only after an error that has already been reported
  device_memory_account.held -= bytes;
}

void copy_to_device(void* to, void const* from, std::size_t bytes) {
  check(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "cudaMemcpy to the device");
}

void copy_pinned_to_device(void* to, void const* from, std::size_t bytes) {
  check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice), "cudaMemcpyAsync to the device");
}

void copy_to_host(void* to, void const* from, std::size_t bytes) {
  check(cudaMemcpy(to, from, bytes, cudaMemcpyDeviceToHost), "cudaMemcpy from the device");
}

void zero_on_device(void* memory, std::size_t bytes) { check(cudaMemset(memory, 0, bytes), "cudaMemset"); }

void wait_for_device() { check(cudaDeviceSynchronize(), "cudaDeviceSynchronize"); }

void* allocate_pinned(std::size_t bytes) {
  void* memory = nullptr;
  check(cudaMallocHost(&memory, bytes), "cudaMallocHost");
  return memory;
}

void release_pinned(void* memory) noexcept {
  if (memory) cudaFreeHost(memory);
}

}  // namespace gladstone::cuda::inline device
