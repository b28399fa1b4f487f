#include "render/files/open_image.h"

#include <fmt/format.h>

#include <utility>

#include "render/base/interrupt.h"
#include "render/files/image_levels.h"

namespace gladstone::inline files {

std::unique_ptr<PageReader> open_by_codecs(std::string const& path) {
  try {
    return loaded_image_codecs().open(path);
  } catch (DataError const& error) {
    throw DataError(error.code(), path,
                    std::string("requires the image codecs, since it is not an intact TIFF: ") + error.what());
  }
}

void report_damaged_page(std::string const& path, std::size_t page) {
  throw DataError(ErrorCode::damaged, path,
                  fmt::format("page {} cannot be read (the file is damaged); copy it again", page + 1));
}

OpenImage::OpenImage(std::string const& path) : path_(path), file_(path, "an image") {
  auto tiff = open_tiff(file_);
  tiff_ = tiff.get();
  input_ = std::move(tiff);
  if (!input_) input_ = open_by_codecs(path);
  if (!input_) {
    std::string const samples = describe_tiff_samples(file_);
    throw DataError(samples.empty() ? ErrorCode::wrong_format : ErrorCode::unsupported, path,
                    "cannot be read as an image (it is of another format, " +
                        (samples.empty() ? "" : "a TIFF with " + samples + ", ") +
                        "damaged or cut short); give TIFF, PNG, JPEG or EXR, if necessary written again without "
                        "compression");
  }
  count_pages();
}

void OpenImage::count_pages() {
  constexpr int first_rotated = 5;  // orientations 5 to 8 exchange columns and rows
  PageHeader const first = input_->header();
  for (int page = 0; input_->seek(page); ++page) {
    throw_if_interrupted();
    if (page == most_pages()) {
      has_more_pages_ = true;
      break;
    }
    PageHeader const spec = input_->header();
    if (spec.width < first.width && spec.height < first.height) continue;
    std::array<int, 2> size{spec.width, spec.height};
    if (spec.orientation >= first_rotated) std::swap(size[0], size[1]);
    pages_.push_back({page, tiff_ ? tiff_->directory() : 0, size});
  }
  is_cut_short_ = input_->is_cut_short();
  input_->clear_errors();
  input_->seek(0);
}

void OpenImage::seek_only_page() {
  if (pages() > 1) {
    throw DataError(
        ErrorCode::wrong_shape, path_,
        fmt::format(
            "has {} pages, but a single image is needed; write the intended page to a separate file (a file of two "
            "frames, reference and flow, is passed as the only input: gladstone correlate PAIR.tif -o vectors.csv)",
            pages()));
  }
  if (!input_->seek(pages_[0].index)) report_damaged_page(path_, 0);
}

Image<double> OpenImage::read(std::size_t page, ImageMetadata* metadata) {
  if (!input_->seek(pages_[page].index)) report_damaged_page(path_, page);
  return read_current_page(*input_, file_, metadata, read_grey_levels);
}

}  // namespace gladstone::inline files
