#include "render/files/image_pages.h"

#include <fmt/format.h>

#include <memory>

#include "render/base/error.h"
#include "render/files/image_levels.h"
#include "render/files/input_file.h"
#include "render/files/open_image.h"
#include "render/files/tiff_reader.h"

namespace gladstone::inline files {

ImagePages::ImagePages(std::string const& path) : path_(path) {
  name_memory_error(path, [&] {
    OpenImage const image(path);
    if (image.has_more_pages()) {
      throw DataError(
          ErrorCode::out_of_range, path,
          fmt::format("has more than {} pages (which is the limit{}); write its pages to several files",
                      image.most_pages(), image.most_pages() == max_pages ? "" : " of this format or compression"));
    }
    file_size_ = image.file_size();
    pages_ = image.locations();
    is_cut_short_ = image.is_cut_short();
  });
}

PageLocation const& ImagePages::locate(std::size_t page) const {
  if (page < pages_.size()) return pages_[page];
  throw DataError(ErrorCode::missing_content, path_,
                  fmt::format("has {} {}, and no page {}; copy it again", pages_.size(),
                              pages_.size() == 1 ? "page" : "pages", page + 1));
}

Image<double> ImagePages::read(std::size_t page, ImageMetadata* metadata) const {
  PageLocation const& location = locate(page);
  return name_memory_error(path_, [&] {
    InputFile const file(path_, "an image");
    if (file.size() != file_size_)
      throw DataError(ErrorCode::inconsistent, path_,
                      "has another size than when its pages were counted; wait until it is complete");
    bool const is_tiff = location.directory != 0;
    std::unique_ptr<PageReader> const input =
        is_tiff ? open_tiff_page(file, location.directory) : open_by_codecs(path_);
    if (!input || !input->seek(is_tiff ? 0 : location.index)) report_damaged_page(path_, page);
    return read_current_page(*input, file, metadata, read_grey_levels);
  });
}

}  // namespace gladstone::inline files
