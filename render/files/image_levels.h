#pragma once

#include <cstdint>
#include <string>

#include "render/base/image.h"
#include "render/files/image_codecs.h"
#include "render/files/image_file.h"

namespace gladstone::inline files {

/// Reads the current page of an image file as grey levels, upright.
/// @param path        for errors
/// @param file_bytes  size of the file [bytes]; the page must fit into it
/// @throws DataError for a damaged page, and for channels that are neither grey levels nor colours
Image<double> read_grey_levels(PageReader& input, std::string const& path, std::uint64_t file_bytes);

/// Reads the current page as read_grey_levels() does, without converting integers of 8 or 16 bits to real numbers.
StoredLevels read_stored_levels(PageReader& input, std::string const& path, std::uint64_t file_bytes);

}  // namespace gladstone::inline files
