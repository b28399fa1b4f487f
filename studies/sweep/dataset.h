#pragma once

#include <cstddef>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone {

/// What was packed.
struct PackedDataset {
  std::size_t cases = 0;    ///< in the file
  std::size_t without = 0;  ///< cases of the study that are not: not finished, or computed without --keep-images
};

/// Packs images and truth of the cases whose folders a study has kept into one HDF5 file, for people who train and test
/// estimators (docs/file-formats.md), with true displacements at pixels that are computed from the cases' setups
/// (displacement_truth.h). One case is in memory at a time.
/// @param path must not be a file of the run
/// @throws DataError where no case has images, their sizes differ, cases of BOS and PIV are mixed, or a file that a
///         case was rendered from has changed; OutputError
PackedDataset pack_dataset(std::string const& run, std::string const& path, Renderer& renderer);

}  // namespace gladstone
