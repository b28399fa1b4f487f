#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "studies/case/render_setup.h"

namespace gladstone::inline cases {

/// Result of rendering a sequence.
struct RenderedSequence {
  std::string summary;     ///< contents of summary.json
  std::size_t frames = 0;  ///< number of frames of each camera
  std::size_t pairs = 0;
  std::size_t resumed = 0;  ///< number of pairs rendered by an earlier run
  double seconds = 0;       ///< wall time [s]
  Warnings warnings;        ///< warnings of the pairs after the first, which logs its own
};

/// Renders a setup with a table [sequence] into a folder, in which every pair is an ordinary CASE:
/// - pair_0000/, pair_0001/, ...: the CASE of each pair (several cameras: with a subfolder for each). PIV: pair k has
///   the frames k and k + 1. BOS: pair k, from 1, has the reference image and field k.
/// - frames/frame_0000.tif, ... (several cameras: frames/CAMERA/): the frames, in the order of `gladstone correlate`.
///   Every frame is rendered once: frame A of a pair is the image that an earlier pair recorded.
/// - sequence.toml and summary.json: setup and state of the sequence.
/// All pairs have the exposure of the first one. Only one pair at a time is in memory.
class SequenceRenderer {
 public:
  /// @param path  path of the setup file, from which the document was read
  /// @throws SetupError if the setup is invalid
  SequenceRenderer(SetupDocument document, std::string path);

  /// @throws OutputError if rendering into the folder would overwrite one of the setup's input files
  void refuse_over_inputs(std::string const& folder) const;

  /// Renders the pairs in their order. Pairs that an earlier run of the same setup, input files and version completed
  /// in the folder are retained.
  /// @param show_progress  report the progress on stderr
  /// @throws OutputError if the folder contains other files, or the sequence of another setup; DataError; DeviceError;
  ///         Interrupted, with the finished pairs stored
  RenderedSequence render(Renderer& renderer, std::string const& folder, bool show_progress);

 private:
  /// Returns the setup of a pair after the first.
  SetupRenderer pair_setup(std::size_t number) const;
  /// Checks that the density files of a BOS sequence can be read and have one size. @throws SetupError
  void check_fields(std::vector<std::string> const& files) const;

  std::string path_;
  SetupDocument document_;
  SetupRenderer first_;  ///< first pair, whose number is part of its setup
  std::size_t first_pair_ = 0, pair_count_ = 0;
};

}  // namespace gladstone::inline cases
