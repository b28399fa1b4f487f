#pragma once

#include <memory>

namespace gladstone::cuda::inline device {

/// Measures, on the device, the time taken by work on the default stream. Does not include CUDA headers, so that
/// benchmarks can use it.
class DeviceTimer {
 public:
  /// @throws DeviceError
  DeviceTimer();
  ~DeviceTimer();

  /// Starts the interval at the end of the work queued so far.
  void start();
  /// Waits for the work queued since start() and returns its time [s].
  double stop();

 private:
  struct Events;
  std::unique_ptr<Events> events_;
};

}  // namespace gladstone::cuda::inline device
