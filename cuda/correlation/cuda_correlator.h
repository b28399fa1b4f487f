#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"
#include "cuda/device/device_image.h"

namespace gladstone::cuda {

/// StandardCorrelator on the device: the same per-pixel, per-window and per-vector functions, with the transform done
/// beside them. Between the passes nothing leaves the device. Its memory is kept for the next pair of the same size;
/// calls from several threads wait for each other. By uncertainty = "correlation_statistics" the vectors come with what
/// estimate_uncertainty() gives for them as they are; by any other without sigma_px.
class CudaCorrelator final : public Correlator {
 public:
  explicit CudaCorrelator(CorrelationSettings const& settings);
  ~CudaCorrelator() override;

  /// As Correlator::correlate. @throws also DeviceError
  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override;
  /// Frames of this device's renderer are taken where they are.
  DisplacementField correlate_pair(FramePair const& frames) const override;
  /// The same for images that are on the device already, complete on the default stream.
  DisplacementField correlate(DeviceImage const& reference, DeviceImage const& flow) const;
  /// Queues the same work and returns before it is done: the vectors stay on the device, until the next pair's.
  void enqueue(DeviceImage const& reference, DeviceImage const& flow) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gladstone::cuda
