#pragma once

#include <string>

#include "analysis/vectors/sequence_statistics.h"

namespace gladstone {

/// Draws maps of the mean and of the standard deviation of both components over a sequence. Points without a value are
/// grey.
/// @pre the points are a grid
/// @throws GnuplotMissing, OutputError
void write_sequence_figure(std::string const& path, SequenceMoments const& moments);

}  // namespace gladstone
