#pragma once

#include <string>

#include "render/base/image.h"

namespace gladstone::inline preparation {

/// Reads an image that must have the size of the frames.
/// @throws DataError if the image cannot be read, has another size, or has pixels that are nan or infinite
Image<double> read_frame_sized_image(std::string const& file, Image<double> const& frame);

}  // namespace gladstone::inline preparation
