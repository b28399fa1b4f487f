#pragma once

#include <string>

#include "render/files/image_codecs.h"
#include "render/files/image_file.h"

namespace gladstone::inline files {

/// Returns the text of the entry ImageDescription of an image: a first line that holds bit depth and pixel pitch, and
/// below it the description.
std::string image_description(ImageMetadata const& metadata);

/// Returns the metadata of a page: as written by gladstone, else bit depth and resolution from the page's header.
ImageMetadata metadata_of(PageHeader const& header);

}  // namespace gladstone::inline files
