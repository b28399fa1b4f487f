#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/base/frame_pair.h"
#include "render/base/setup_table.h"

/// What is done to frames before they are correlated: steps that change grey levels, and masks.
namespace gladstone {

/// Frames under preparation.
struct PreparedFrames {
  Image<double> reference;
  Image<double> flow;
  Image<double> known;  ///< 1 where both frames count, 0 elsewhere; grey levels there stand for nothing
};

/// One mask or step, as its settings make it. @throws DataError where its files do not suit the frames
using FrameChange = std::function<void(PreparedFrames& frames)>;

/// The arrays of tables [[correlate.mask]] and [[correlate.preprocess]] of a setup, in their order.
struct FramePreparation {
  std::vector<FrameChange> masks;
  std::vector<FrameChange> steps;
  std::vector<std::string> files;  ///< pictures that these read

  bool empty() const { return masks.empty() && steps.empty(); }
};

/// Names of the masks and of the steps, as `kind` takes them.
std::vector<std::string> mask_kinds();
std::vector<std::string> preprocessing_kinds();

/// @param correlate the table [correlate]; problems are collected in its document
FramePreparation read_frame_preparation(SetupTable& correlate);

/// The frames with steps done and, in both, NaN where either is unknown or a mask lies: correlators leave such pixels
/// out. Masks look at the frames as they were taken, and are laid on in the end; before, what is unknown or masked has
/// the mean of the rest, so that its light reaches nothing.
/// @throws DataError
HostFrames prepare_frames(FramePair const& frames, FramePreparation const& preparation);

/// Part of the pixels that are not left out, 0 .. 1.
double known_part(FramePair const& frames);

}  // namespace gladstone
