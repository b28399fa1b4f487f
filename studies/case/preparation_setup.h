#pragma once

#include "analysis/preparation/frame_preparation.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline cases {

/// Frames that are prepared together.
enum class PreparedSet {
  pair,     ///< two frames: "background" steps require `frame`
  sequence  ///< many pairs: "background" steps without `frame` subtract the background of the sequence
};

/// Reads the arrays [[correlate.mask]] and [[correlate.preprocess]] of a setup, in their order.
/// @param correlate  table [correlate]; problems are collected in its document
FramePreparation read_frame_preparation(SetupTable& correlate, PreparedSet set = PreparedSet::pair);

}  // namespace gladstone::inline cases
