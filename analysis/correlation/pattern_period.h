#pragma once

#include <optional>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/image.h"

namespace gladstone::inline correlation {

/// Period of a repeating pattern.
struct PatternPeriod {
  double pitch_px;  ///< shortest shift at which the pattern matches itself [px]
  /// Ratio of the autocorrelation at the pitch to that at shift 0, without the contribution of noise [1].
  double height;
};

/// Determines the period of a pattern from the autocorrelation of up to sixteen windows of twice the first pass'
/// window, at least 128 px, so that a few dots do not match by coincidence.
/// The pattern in a window repeats if a side peak is at least ambiguous_height_ratio times as high as the main peak.
/// Because uncorrelated noise affects only the sample at shift 0, the peaks are also compared at one pixel from their
/// centres along the axes: the samples of the main peak with the Gaussian fitted to the side peak. Dots of one pixel
/// have no signal at this distance, and are compared at the peak centres.
/// @return nullopt if the pattern repeats in fewer than a quarter of the windows within twice the search range of the
/// first pass; a smaller period makes displacements within the search range ambiguous
std::optional<PatternPeriod> pattern_period(Image<double> const& image, CorrelationSettings const& settings);

}  // namespace gladstone::inline correlation
