#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/stereo/sheet_alignment.h"
#include "render/files/source_files.h"

namespace gladstone::inline compare {

/// Determines the laser sheet from images of both cameras, see stereo::align_sheet().
/// @param images   image files of the first and of the second camera in turn, two for each time
/// @param sources  extended by the hashes of the images
/// @throws DataError if an image is missing or unreadable, the images of a camera differ in size, or the sheet is not
///         determined
stereo::SheetAlignment align_sheet_of_files(std::vector<std::string> const& images,
                                            std::array<PinholeCamera const*, 2> const& cameras,
                                            stereo::ObjectPlane const& plane, SourceFiles& sources);

/// Measures the disparity of the assumed plane between images of both cameras, without aligning it.
/// @param images, sources  as for align_sheet_of_files()
/// @return nullopt if the images do not determine the disparity
/// @throws DataError if an image is missing or unreadable, or the images of a camera differ in size
std::optional<stereo::SheetAlignment> measure_disparity(std::vector<std::string> const& images,
                                                        std::array<PinholeCamera const*, 2> const& cameras,
                                                        stereo::ObjectPlane const& plane, SourceFiles& sources);

}  // namespace gladstone::inline compare
