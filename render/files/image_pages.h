#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/files/image_file.h"

/// Image files of several pages, such as the frames of a recording.
namespace gladstone::inline files {

/// Location of a page in its file.
struct PageLocation {
  int index = 0;                ///< index among all pages, with previews
  std::uint64_t directory = 0;  ///< offset of the page's directory in a TIFF [bytes]; 0: other formats
  std::array<int, 2> size{};    ///< columns and rows of the upright image [px]
};

/// Pages of an image file. They are located once, so that reading one takes the same time for any number of pages. The
/// file is open only during a call; several threads may read pages at once.
class ImagePages {
 public:
  /// Locates the pages. Pages smaller than the first in both directions are previews, which are not counted. A page
  /// that the file declares, but that cannot be read since the file is cut short, is counted.
  /// @throws DataError, with the code out_of_range if there are more than max_pages pages (TIFF) or max_codec_pages
  explicit ImagePages(std::string const& path);

  std::size_t count() const { return pages_.size() + (is_cut_short_ ? 1 : 0); }
  /// Returns columns and rows of a page [px]. @throws DataError if the page cannot be read
  std::array<int, 2> size(std::size_t page) const { return locate(page).size; }
  /// Reads a page as read_image() does.
  /// @param page  index from 0, below count()
  /// @throws DataError, also if the page cannot be read, or the size of the file has changed
  Image<double> read(std::size_t page, ImageMetadata* metadata = nullptr) const;

 private:
  PageLocation const& locate(std::size_t page) const;

  std::string path_;
  std::uint64_t file_size_ = 0;
  std::vector<PageLocation> pages_;
  bool is_cut_short_ = false;
};

}  // namespace gladstone::inline files
