#pragma once

#include <optional>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/image.h"

namespace gladstone {

/// A pattern that repeats.
struct PatternPeriod {
  double pitch_px;  ///< shortest shift by which it matches itself
  double height;    ///< of the autocorrelation there over that at no shift, noise aside
};

/// The period of a pattern, from the autocorrelation of up to sixteen windows of twice the first pass' size, at least
/// 128 px, so that few dots do not match by chance. A window repeats where a side peak is nearly as high as the main
/// one (nearly_as_high). Noise, which stands on the sample at no shift alone, is kept out by comparing them one pixel
/// from their middles along the axes: at the samples of the main peak, on the Gaussian through those of the side peak.
/// Points of one pixel have nothing there, and are compared at their middles.
/// @return nothing where fewer than a quarter of the windows repeat within twice the first pass' search range: a shift
///         by less than that leads from one displacement within it to another
std::optional<PatternPeriod> pattern_period(Image<double> const& image, CorrelationSettings const& settings);

}  // namespace gladstone
