#pragma once

#include <string>

#include "render/base/image.h"

namespace gladstone {

/// Reads a picture that is to have the frames' size. @throws DataError where it cannot be read, has another size, or
/// pixels that are nan or infinite
Image<double> read_sized_picture(std::string const& file, Image<double> const& frame);

}  // namespace gladstone
