#pragma once

#include <cstddef>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone::inline sweep {

/// Numbers of packed and omitted cases.
struct PackedDataset {
  std::size_t cases = 0;    ///< number of cases in the file
  std::size_t without = 0;  ///< number of omitted cases: not finished, or computed without --keep-images
};

/// Refuses a path that is a table, the manifest or the settings of a run. @throws DataError
void refuse_files_of_study(std::string const& run, std::string const& path);

/// Packs images and truth of a study's cases into one HDF5 file for training and testing displacement estimators
/// (docs/file-formats.md). Includes maps of the true displacement at pixels, computed from the setups of the cases
/// (displacement_truth.h). Only cases computed with --keep-images are packed, one at a time in memory.
/// @param path  output file, which must not be a file of the run
/// @throws DataError if no case has images, image sizes differ, BOS and PIV cases are mixed, or an input file of a case
///         has changed; OutputError
PackedDataset pack_dataset(std::string const& run, std::string const& path, Renderer& renderer);

}  // namespace gladstone::inline sweep
