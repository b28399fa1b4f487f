#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"
#include "render/base/image.h"

namespace gladstone::inline correlation {

/// Measures the displacement field between two images.
class Correlator {
 public:
  virtual ~Correlator() = default;
  /// Measures the displacement from frame A to frame B.
  /// @param reference,  flow  grey levels of frame A and frame B, of equal size; pixels that are not finite are masked
  /// @return one vector per window of final_grid(), in px: u to the right, v downwards, at the mid-position between the
  /// frames; NaN if its status is masked (more than half of the window is unknown) or invalid (no signal, or spurious
  /// and not replaced). Tracking with output "scattered" returns one vector per dot instead. sigma_px is empty unless
  /// the correlator's device or method estimates the uncertainty together with the vectors. The field's verdict is
  /// empty unless the correlator has performed the decorrelation test itself. The result is bitwise the same for any
  /// number of threads.
  /// @throws DataError if the sizes differ or a window does not fit into the image; Interrupted
  virtual DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const = 0;
  /// Measures the displacement like correlate(), for frames in host or device memory. Frames on the correlator's own
  /// device are not copied to the host.
  virtual DisplacementField correlate_pair(StoredFrames const& frames) const {
    return correlate(frames.reference(), frames.flow());
  }
};

/// Returns the names accepted as CorrelationSettings::method.
std::vector<std::string> correlation_methods();

/// Creates the correlator for the CPU that the settings select.
/// @pre settings.method is one of correlation_methods(), but not "tracking" (see tracking::make_cpu_correlator())
std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings);

/// Returns the first setting that the CUDA correlator does not support, such as `method = "spc"`; empty if all settings
/// are supported.
std::string missing_on_gpu(CorrelationSettings const& settings);

/// Returns the window grid of the last pass; the vectors are at the window centres.
InterrogationGrid final_grid(CorrelationSettings const& settings, int columns, int rows);

}  // namespace gladstone::inline correlation
