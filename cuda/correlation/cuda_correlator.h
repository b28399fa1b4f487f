#pragma once

#include <memory>

#include "analysis/correlation/correlator.h"
#include "cuda/device/device_image.h"

namespace gladstone::cuda::inline correlation {

/// StandardCorrelator on the device: shares the functions per pixel, window and vector, but not the Fourier transforms.
/// No data are transferred between passes, except for the additional passes where displacement gradients are steep,
/// whose predictors the host computes. Device memory is retained for later pairs of the same size; concurrent calls are
/// serialised. With uncertainty = "correlation_statistics", the result includes sigma_px as by estimate_uncertainty();
/// with other methods sigma_px is empty.
class CudaCorrelator final : public Correlator {
 public:
  explicit CudaCorrelator(CorrelationSettings const& settings);
  ~CudaCorrelator() override;

  /// Like Correlator::correlate(). @throws DeviceError in addition
  DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const override;
  /// Frames rendered on this device are correlated without a copy to the host.
  DisplacementField correlate_pair(StoredFrames const& frames) const override;
  /// Correlates images in device memory; the work that produces them must be queued on the default stream.
  DisplacementField correlate(DeviceImage const& reference, DeviceImage const& flow) const;
  /// Queues the correlation; the vectors remain on the device until the next pair. With several passes, it waits for
  /// the last one to find out whether gradients are steep, unless steep_passes is 0.
  void enqueue(DeviceImage const& reference, DeviceImage const& flow) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gladstone::cuda::inline correlation
