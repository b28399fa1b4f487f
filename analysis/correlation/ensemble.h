#pragma once

#include <cstddef>
#include <functional>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone::inline correlation {

/// Sequence of image pairs with a common displacement field, indexed from 0. Each pair is requested once per pass.
struct PairSequence {
  std::size_t size = 0;
  std::function<HostFrames(std::size_t pair)> frames;
};

/// Measures the displacement field common to all pairs (ensemble correlation). Each pass finds the peaks in the mean of
/// the pairs' correlation planes, so that few particles or strong noise in single pairs are tolerated. Displacements
/// that differ between pairs are averaged and broaden the peak. Meinhart, Wereley & Santiago, J. Fluids Eng. 122 (2000)
/// 285.
/// @return vectors as described at Correlator::correlate(); they are computed on the CPU
/// @throws DataError if sizes differ, a window does not fit into the image, or the method or the uncertainty estimator
/// applies to single pairs only
DisplacementField correlate_ensemble(PairSequence const& pairs, CorrelationSettings const& settings);

}  // namespace gladstone::inline correlation
