#pragma once

#include <cstddef>
#include <string>

#include "render/files/image_file.h"

/// Image files of several pages, such as the frames of a recording.
namespace gladstone {

/// Counts the pages of an image file. Pages smaller than the first in both directions are previews and do not count.
/// A page that the file declares, but that cannot be read since the file is cut short, counts.
/// @throws DataError, also if there are more than max_pages pages
std::size_t count_pages(std::string const& path);

/// Reads one page of an image file as read_image() does.
/// @param page  index from 0, as counted by count_pages()
/// @throws DataError, also if the page does not exist
Image<double> read_page(std::string const& path, std::size_t page, ImageMetadata* metadata = nullptr);

}  // namespace gladstone
