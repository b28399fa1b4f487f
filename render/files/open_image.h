#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "render/base/error.h"
#include "render/files/image_codecs.h"
#include "render/files/image_description.h"
#include "render/files/image_file.h"
#include "render/files/image_pages.h"
#include "render/files/input_file.h"
#include "render/files/tiff_reader.h"

namespace gladstone::inline files {

/// Opens an image by the image codecs. An error in loading them names the image that requires them.
std::unique_ptr<PageReader> open_by_codecs(std::string const& path);

/// Throws the error for a page that cannot be read. @param page  index from 0
[[noreturn]] void report_damaged_page(std::string const& path, std::size_t page);

/// Reads the current page of a file by read_grey_levels() or read_stored_levels().
template <class Levels>
Levels read_current_page(PageReader& input, InputFile const& file, ImageMetadata* metadata,
                         Levels (*read)(PageReader&, std::string const&, std::uint64_t)) {
  PageHeader const spec = input.header();
  Levels image = read(input, file.path(), file.size());
  if (metadata) {
    *metadata = metadata_of(spec);
    metadata->channels = spec.colours == Colours::inks ? spec.channels - 1 : spec.channels;
    metadata->sample_bits = spec.bits;
    metadata->orientation = spec.orientation;
  }
  return image;
}

/// Image file opened for reading.
class OpenImage {
 public:
  /// @throws DataError if the file cannot be read as an image
  explicit OpenImage(std::string const& path);

  /// Number of pages, without the previews of the first one, which are smaller in both directions.
  std::size_t pages() const { return pages_.size(); }
  /// True if the file declares a further page that cannot be read.
  bool is_cut_short() const { return is_cut_short_; }
  /// True if the file has more than most_pages() pages.
  bool has_more_pages() const { return has_more_pages_; }
  int most_pages() const { return tiff_ ? max_pages : max_codec_pages; }
  std::uint64_t file_size() const { return file_.size(); }
  std::vector<PageLocation> const& locations() const { return pages_; }

  /// Reads a page, counted from 0 without previews.
  Image<double> read(std::size_t page, ImageMetadata* metadata);
  /// Reads the only page. @param read  read_grey_levels or read_stored_levels
  template <class Levels>
  Levels read_only_page(ImageMetadata* metadata, Levels (*read)(PageReader&, std::string const&, std::uint64_t)) {
    seek_only_page();
    return read_current_page(*input_, file_, metadata, read);
  }

 private:
  /// Collects the pages that are not previews of the first one, up to most_pages().
  void count_pages();
  /// Moves to the only page. @throws DataError if there are several
  void seek_only_page();

  std::string path_;
  InputFile file_;
  std::unique_ptr<PageReader> input_;
  TiffPageReader const* tiff_ = nullptr;  ///< input_ if it is a TIFF
  std::vector<PageLocation> pages_;
  bool has_more_pages_ = false, is_cut_short_ = false;
};

/// Calls `read`, and converts a failed allocation into an error of code `memory` that names the file.
template <class Read>
auto name_memory_error(std::string const& path, Read const& read) {
  try {
    return read();
  } catch (std::bad_alloc const&) {
    throw DataError(ErrorCode::memory, path,
                    "does not fit into memory; give a smaller image, or use a machine with more");
  } catch (std::length_error const&) {
    throw DataError(ErrorCode::memory, path,
                    "does not fit into memory; give a smaller image, or use a machine with more");
  }
}

}  // namespace gladstone::inline files
