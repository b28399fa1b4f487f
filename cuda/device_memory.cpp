#include "cuda/device_memory.h"

#include <cstdint>

#include "cuda/cuda_error.h"

namespace gladstone::cuda {
namespace {

/// Enters memory into the account. @return false where the limit does not allow it
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

}  // namespace

DeviceRoom device_room() {
  check(cudaStreamSynchronize(nullptr), "cudaStreamSynchronize");  // memory is given back in the order of the stream
  DeviceRoom room{};
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

void* allocate_on_device(std::size_t bytes, std::string const& what_for) {
  if (!enter(bytes)) throw OutOfDeviceMemory(what_for, bytes);
  void* memory = nullptr;
  cudaError_t const status = cudaMallocAsync(&memory, bytes, nullptr);
  if (status == cudaSuccess) return memory;
  device_memory_account.held -= bytes;
  if (status != cudaErrorMemoryAllocation) check(status, "cudaMallocAsync");
  cudaGetLastError();  // the failure is not sticky: forget it
  throw OutOfDeviceMemory(what_for, bytes);
}

void release_on_device(void* memory, std::size_t bytes) noexcept {
  if (!memory) return;
  cudaFreeAsync(memory, nullptr);  // fails only after an error that was reported where it happened
  device_memory_account.held -= bytes;
}

}  // namespace gladstone::cuda
