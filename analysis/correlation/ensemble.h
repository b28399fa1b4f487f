#pragma once

#include <cstddef>
#include <functional>

#include "analysis/correlation/correlation_settings.h"
#include "render/base/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone {

/// Many pairs of one displacement, by their number from 0; each is asked for once a pass.
struct PairSequence {
  std::size_t size = 0;
  std::function<HostFrames(std::size_t pair)> frames;
};

/// The one displacement of all pairs: each pass finds the peaks of the mean of their correlation planes, so that few
/// particles, or noise, that leave no peak in a single pair do no harm. What differs from pair to pair is averaged, and
/// broadens the peak. Meinhart, Wereley & Santiago, J. Fluids Eng. 122 (2000) 285.
/// @return as Correlator::correlate, on the CPU
/// @throws DataError where sizes differ or a window does not fit, or method or uncertainty are of single pairs alone
DisplacementField correlate_ensemble(PairSequence const& pairs, CorrelationSettings const& settings);

}  // namespace gladstone
