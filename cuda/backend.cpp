#include "cuda/backend.h"

#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include <atomic>
#include <string>
#include <utility>

#include "cuda/correlation/cuda_correlator.h"
#include "cuda/device/copy_samples.h"
#include "cuda/device/cuda_error.h"
#include "cuda/device/device_frames.h"
#include "cuda/device/runnable_code.h"
#include "cuda/focused_dots/cuda_renderer.h"
#include "cuda/ideal_images/cuda_image_drawer.h"
#include "cuda/ideal_images/cuda_pair_batches.h"
#include "cuda/rays/cuda_rays_renderer.h"
#include "cuda/tomography/cuda_volume.h"

namespace gladstone::cuda {
namespace {

/// Tests whether a device is usable. A successful test is not repeated, since reading the properties of a device takes
/// a millisecond.
/// @throws DeviceError  if no device is usable
void require_device() {
  static std::atomic<bool> usable = false;
  if (usable) return;
  if (DeviceState const state = device_state(); !state.usable) throw DeviceError(state.text);
  usable = true;
}

}  // namespace

bool compiled_in() { return true; }

std::string description() {
  return "compiled in, CUDA toolkit " GLADSTONE_CUDA_VERSION ", for sm_" GLADSTONE_CUDA_ARCHITECTURES;
}

DeviceState device_state() {
  int count = 0;
  cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count == 0) status = cudaErrorNoDevice;
  cudaDeviceProp device{};
  if (status == cudaSuccess) status = cudaGetDeviceProperties(&device, 0);
  // Create the context: reports a device that is in exclusive use or faulty.
  if (status == cudaSuccess) status = cudaFree(nullptr);
  if (status != cudaSuccess) cudaGetLastError();  // clear the error, so that the next launch is not reported as failed
  if (status == cudaErrorInsufficientDriver)
    return {false, "the NVIDIA driver is absent or older than this CUDA build needs"};
  if (status != cudaSuccess) {
    return {false, fmt::format("no usable CUDA device: {}", cudaGetErrorString(status))};
  }
  if (std::string const why = reason_code_cannot_run(); !why.empty()) {
    return {false, fmt::format("{} cannot be used: {}", device.name, why)};
  }
  return {true, fmt::format("{}, {:.0f} GiB", device.name, static_cast<double>(device.totalGlobalMem) / 0x1p30)};
}

int device_count() {
  int count = 0;
  if (cudaGetDeviceCount(&count) == cudaSuccess) return count;
  cudaGetLastError();
  return 0;
}

int device_of_memory(void const* address) {
  if (device_count() == 0) return -1;
  cudaPointerAttributes attributes{};
  check(cudaPointerGetAttributes(&attributes, address), "cudaPointerGetAttributes");
  return attributes.type == cudaMemoryTypeDevice ? attributes.device : -1;
}

std::unique_ptr<Renderer> make_renderer() {
  require_device();
  return std::make_unique<CudaRenderer>();
}

std::unique_ptr<Renderer> make_rays_renderer() {
  require_device();
  return std::make_unique<CudaRaysRenderer>();
}

std::unique_ptr<ImageDrawer> make_image_drawer() {
  require_device();
  return std::make_unique<CudaImageDrawer>();
}

std::unique_ptr<PairBatchRenderer> make_pair_batches(std::vector<OwnedPairModel> const& models) {
  require_device();
  return std::make_unique<CudaPairBatches>(models);
}

std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings) {
  if (std::string const missing = missing_on_gpu(settings); !missing.empty())
    throw DeviceError("correlate." + missing + " is computed on the CPU only");
  require_device();
  return std::make_unique<CudaCorrelator>(settings);
}

CopiedFrames copy_frames(ImageSamples const& reference, ImageSamples const& flow) {
  require_device();
  auto frames = std::make_unique<DeviceFrames>(static_cast<int>(reference.columns), static_cast<int>(reference.rows));
  DeviceArray<unsigned long long> counts(frame_count, "the images");
  counts.zero();
  copy_samples(reference, frames->levels(Frame::reference), counts.data());
  copy_samples(flow, frames->levels(Frame::flow), counts.data() + 1);
  unsigned long long not_finite[frame_count];
  counts.download(not_finite, frame_count);  // waits until the images are copied
  return {std::move(frames), {not_finite[0], not_finite[1]}};
}

std::unique_ptr<SartVolume> make_volume(SartProblem const& problem) {
  require_device();
  return make_cuda_volume(problem);
}

}  // namespace gladstone::cuda
