#pragma once

#include <string>

#include "render/files/image_file.h"
#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// Describes an image file: size, grey levels, dot diameter and noise.
/// @throws DataError if it cannot be read, or has no finite pixel
Description describe_image(std::string const& path);
/// Describes an image in memory. @param name  for messages
Description describe_image(std::string const& name, Image<double> const& image, ImageMetadata const& metadata);

}  // namespace gladstone::inline commands
