#pragma once

#include <cstddef>
#include <optional>

#include "render/setup/setup_table.h"

namespace gladstone {

/// Table [sequence] of a setup: the pair of a sequence of frames that the setup describes.
struct SequenceSetup {
  /// PIV: frames `pair` and `pair` + 1, from 0. BOS: the reference image and the field number `pair`, from 1.
  std::size_t pair = 0;
  std::size_t frames = 2;  ///< PIV: number of frames
  double dt = 0;           ///< PIV: time between consecutive frames [s]

  std::size_t first_frame(bool piv) const { return piv ? pair : 0; }
  std::size_t second_frame(bool piv) const { return piv ? pair + 1 : pair; }
};

struct Setup;

/// Reads table [sequence] of a BOS or PIV setup; nullopt if it is absent.
std::optional<SequenceSetup> read_sequence_setup(SetupTable root, bool piv);

/// Reports properties of a setup that a sequence excludes: other fields than files (BOS), pulses that differ (PIV).
void check_sequence(Setup const& setup, SetupTable root);

}  // namespace gladstone
