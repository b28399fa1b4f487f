#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/correlation/interrogation_grid.h"
#include "render/base/displacement_field.h"
#include "render/base/frame_pair.h"
#include "render/base/image.h"

namespace gladstone {

/// Measures the displacement between two images.
class Correlator {
 public:
  virtual ~Correlator() = default;
  /// @param reference, flow grey levels, of equal size; pixels that are not finite are masked out
  /// @return one vector per window of final_grid(): displacement = flow - reference [px], belonging to the
  /// mid-position;
  ///         NaN where the status is masked (half the window unknown) or invalid (no signal, or spurious without a
  ///         sound neighbour). sigma_px is empty but where a device estimates it along with the vectors. The same bits
  ///         for any number of threads.
  /// @throws DataError where the sizes differ or a window does not fit, Interrupted
  virtual DisplacementField correlate(Image<double> const& reference, Image<double> const& flow) const = 0;
  /// The same for frames wherever they are kept; those that are on the correlator's own device stay there.
  virtual DisplacementField correlate_pair(FramePair const& frames) const {
    return correlate(frames.reference(), frames.flow());
  }
};

/// Names of the methods that make_correlator knows.
std::vector<std::string> correlation_methods();

/// The correlator that the settings ask for. @pre settings.method is one of correlation_methods()
std::unique_ptr<Correlator> make_correlator(CorrelationSettings const& settings);

/// What these settings ask for that the correlator of CUDA does not have, as `method = "spc"`; empty: it has all.
std::string missing_on_gpu(CorrelationSettings const& settings);

/// The windows of the last pass, where the vectors stand.
InterrogationGrid final_grid(CorrelationSettings const& settings, int columns, int rows);

}  // namespace gladstone
