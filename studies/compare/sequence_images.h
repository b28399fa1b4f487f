#pragma once

#include <string>
#include <vector>

#include "analysis/preparation/sequence_background.h"
#include "render/base/image.h"
#include "render/base/warning.h"
#include "studies/compare/sequence_frames.h"

namespace gladstone::inline compare {

/// Frame of a sequence, read from its file.
struct SequenceImage {
  Image<double> levels;
  std::string sha256;  ///< pixel_sha256()
  Warnings warnings;
};
/// Reads a frame. @throws DataError, also if all pixels are NaN or infinite
SequenceImage read_sequence_image(SequenceFrame const& frame);

/// Size of the frames of a sequence.
struct SequenceSize {
  int columns = 0, rows = 0;  ///< size of a frame [px]
  std::string frame;          ///< name of the first frame of this size

  /// @throws DataError if a frame has another size, with the names of both
  void require(Image<double> const& levels, std::string const& name) const;
};

/// Finds the commonest size of the frames of all pairs, and of two equally frequent ones that of the earlier frame.
/// Reads no pixels; unreadable frames are ignored.
/// @param pairs  pairs without problem
/// @throws DataError of the first frame if none is readable; Interrupted
SequenceSize find_commonest_size(std::vector<SequencePair> const& pairs);

/// Computes the background of all frames A and that of all frames B, without those that are unreadable, of another size
/// or not finite. With another pairing than Pairing::pairs they are images of one series, and the background is that
/// of all frames.
/// @param pairs  pairs without problem
/// @throws DataError if no frame is suitable; Interrupted
void compute_background_images(SequenceBackground& background, std::vector<SequencePair> const& pairs, Pairing pairing,
                               SequenceSize const& size, bool show_progress);

}  // namespace gladstone::inline compare
