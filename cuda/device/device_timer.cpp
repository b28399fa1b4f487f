#include "cuda/device/device_timer.h"

#include "cuda/device/cuda_error.h"

namespace gladstone::cuda::inline device {

struct DeviceTimer::Events {
  Events() {
    check(cudaEventCreate(&begin), "cudaEventCreate");
    check(cudaEventCreate(&end), "cudaEventCreate");
  }
  Events(Events const&) = delete;
  Events& operator=(Events const&) = delete;
  ~Events() {
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
  }
  cudaEvent_t begin = nullptr, end = nullptr;
};

DeviceTimer::DeviceTimer() : events_(std::make_unique<Events>()) {}
DeviceTimer::~DeviceTimer() = default;

void DeviceTimer::start() { check(cudaEventRecord(events_->begin), "cudaEventRecord"); }

double DeviceTimer::stop() {
  check(cudaEventRecord(events_->end), "cudaEventRecord");
  check(cudaEventSynchronize(events_->end), "cudaEventSynchronize");
  float milliseconds = 0.0f;
  check(cudaEventElapsedTime(&milliseconds, events_->begin, events_->end), "cudaEventElapsedTime");
  return 1e-3 * static_cast<double>(milliseconds);
}

}  // namespace gladstone::cuda::inline device
