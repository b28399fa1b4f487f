#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/stereo/sheet_alignment.h"
#include "render/files/source_files.h"

namespace gladstone::inline compare {

/// Reads images of both cameras.
/// @param files    image files of the first and of the second camera in turn, two for each time
/// @param sources  extended by the hashes of the images
/// @throws DataError if an image is missing or unreadable, or the images of a camera differ in size
std::vector<stereo::SimultaneousImages> read_simultaneous_images(std::vector<std::string> const& files,
                                                                 SourceFiles& sources);

/// Determines the laser sheet from images of both cameras, see stereo::align_sheet().
/// @throws DataError if the sheet is not determined
stereo::SheetAlignment align_sheet_of_images(std::vector<stereo::SimultaneousImages> const& images,
                                             std::array<PinholeCamera const*, 2> const& cameras,
                                             stereo::ObjectPlane const& plane);

/// Measures the disparity of the assumed plane between images of both cameras, without aligning it.
/// @return nullopt if the images do not determine the disparity
std::optional<stereo::SheetAlignment> measure_disparity(std::vector<stereo::SimultaneousImages> const& images,
                                                        std::array<PinholeCamera const*, 2> const& cameras,
                                                        stereo::ObjectPlane const& plane);

}  // namespace gladstone::inline compare
