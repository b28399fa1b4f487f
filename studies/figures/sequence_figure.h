#pragma once

#include "analysis/vectors/sequence_statistics.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Maps of the mean and of the standard deviation of both components over a sequence. Points without a value are
/// grey.
/// @pre the points are a grid
Figure make_sequence_figure(SequenceMoments const& moments);

}  // namespace gladstone::inline figures
