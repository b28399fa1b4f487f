#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace gladstone::inline scene {

/// Largest number of frames of a sequence.
inline constexpr long long max_sequence_frames = 1'000'000;

/// Table [sequence] of a setup: the sequence of frames, and which of its pairs the setup describes.
struct SequenceSetup {
  /// true (PIV): pair k consists of frames k and k + 1, k from 0. false (BOS): pair k consists of the reference image,
  /// frame 0, and frame k, k from 1.
  bool consecutive = false;
  std::size_t pair = 0;
  std::size_t frames = 2;  ///< number of frames, if they are consecutive
  double dt = 0;           ///< time between consecutive frames [s]

  /// Returns the numbers of the frames of a pair.
  std::array<std::uint64_t, 2> frames_of(std::size_t number) const {
    return {consecutive ? number : 0, consecutive ? number + 1 : number};
  }
};

}  // namespace gladstone::inline scene
