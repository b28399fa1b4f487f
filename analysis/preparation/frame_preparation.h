#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "analysis/preparation/sequence_background.h"
#include "render/base/frame_pair.h"

/// Preparation of frames before correlation: masks, and preprocessing steps that change grey levels.
namespace gladstone::inline preparation {

/// Pair of frames during the preparation.
struct PreparedFrames : FramePair<double> {
  /// 1 at pixels that are valid in both frames, else 0; the grey levels of invalid pixels are meaningless.
  Image<double> known;
};

/// Operation of one mask or step with its settings. @throws DataError if its files do not match the frames
using FrameChange = std::function<void(PreparedFrames& frames)>;

/// Masks and preprocessing steps of an evaluation, in the order of their application.
struct FramePreparation {
  std::vector<FrameChange> masks;
  std::vector<FrameChange> steps;
  std::vector<std::string> files;  ///< images that the masks and steps read
  /// Backgrounds of the sequence that the steps subtract; their images are empty until they have been computed.
  std::vector<std::shared_ptr<SequenceBackground>> backgrounds;

  bool empty() const { return masks.empty() && steps.empty(); }
};

/// Applies masks and preprocessing steps. Pixels that are masked or not finite in either frame become NaN in both, and
/// correlators ignore them. Masks are evaluated on the original frames and applied after the steps. During the steps,
/// invalid pixels have the mean grey level of the valid ones, so that their light does not affect their surroundings.
/// @throws DataError if a file of a mask or step does not match the frames
HostFrames prepare_frames(StoredFrames const& frames, FramePreparation const& preparation);

/// Returns the fraction of pixels of the first frame (`reference`) that are not NaN [1].
double valid_pixel_fraction(StoredFrames const& frames);

}  // namespace gladstone::inline preparation
