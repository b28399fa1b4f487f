#pragma once

#include <memory>

namespace gladstone::cuda {

/// Time that work on the default stream takes, measured on the device. No CUDA header here: benchmarks use it.
class DeviceTimer {
 public:
  /// @throws DeviceError
  DeviceTimer();
  ~DeviceTimer();

  /// From the end of the work queued before.
  void start();
  /// To the end of the work queued since start(), which is waited for [s].
  double stop();

 private:
  struct Events;
  std::unique_ptr<Events> events_;
};

}  // namespace gladstone::cuda
