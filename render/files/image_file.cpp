#include "render/files/image_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/version.h"
#include "render/files/image_codecs.h"
#include "render/files/image_description.h"
#include "render/files/image_levels.h"
#include "render/files/image_pages.h"
#include "render/files/input_file.h"
#include "render/files/output_file.h"
#include "render/files/tiff_reader.h"
#include "render/files/tiff_writer.h"

namespace gladstone::inline files {
namespace {

/// Opens an image by the image codecs. An error in loading them names the image that requires them.
std::unique_ptr<PageReader> open_by_codecs(std::string const& path) {
  try {
    return loaded_image_codecs().open(path);
  } catch (DataError const& error) {
    throw DataError(error.code(), path,
                    std::string("requires the image codecs, since it is not an intact TIFF: ") + error.what());
  }
}

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

[[noreturn]] void report_damaged_page(std::string const& path, std::size_t page) {
  throw DataError(ErrorCode::damaged, path,
                  fmt::format("page {} cannot be read (the file is damaged); copy it again", page + 1));
}

/// Image file opened for reading.
class Picture {
 public:
  explicit Picture(std::string const& path) : path_(path), file_(path, "an image") {
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

  /// Number of pages, without the previews of the first one, which are smaller in both directions.
  std::size_t pages() const { return pages_.size(); }
  /// True if the file declares a further page that cannot be read.
  bool is_cut_short() const { return is_cut_short_; }
  /// True if the file has more than most_pages() pages.
  bool has_more_pages() const { return has_more_pages_; }
  int most_pages() const { return tiff_ ? max_pages : max_codec_pages; }
  std::uint64_t file_size() const { return file_.size(); }
  std::vector<PageLocation> const& locations() const { return pages_; }

  Image<double> read(std::size_t page, ImageMetadata* metadata) {
    if (!input_->seek(pages_[page].index)) report_damaged_page(path_, page);
    return read_current_page(*input_, file_, metadata, read_grey_levels);
  }
  /// Reads the only page. @param read  read_grey_levels or read_stored_levels
  template <class Levels>
  Levels read_only_page(ImageMetadata* metadata, Levels (*read)(PageReader&, std::string const&, std::uint64_t)) {
    if (pages() > 1) {
      throw DataError(
          ErrorCode::wrong_shape, path_,
          fmt::format(
              "has {} pages, but a single image is needed; write the intended page to a separate file (a file of two "
              "frames, reference and flow, is passed as the only input: gladstone correlate PAIR.tif -o vectors.csv)",
              pages()));
    }
    if (!input_->seek(pages_[0].index)) report_damaged_page(path_, 0);
    return read_current_page(*input_, file_, metadata, read);
  }

 private:
  /// Collects the pages that are not previews of the first one, up to most_pages().
  void count_pages() {
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

  std::string path_;
  InputFile file_;
  std::unique_ptr<PageReader> input_;
  TiffPageReader const* tiff_ = nullptr;  ///< input_ if it is a TIFF
  std::vector<PageLocation> pages_;
  bool has_more_pages_ = false, is_cut_short_ = false;
};

/// Calls `read`, and converts a failed allocation into an error of code `memory` that names the file.
template <class Read>
auto named(std::string const& path, Read const& read) {
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

/// Returns a number of 32 bits, the most significant byte first.
std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int const shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

/// Returns a chunk: length of the data, type, data, and the CRC-32 of type and data.
std::string png_chunk(std::string const& type, std::string const& data) {
  std::string const body = type + data;
  uLong const crc = crc32(0, reinterpret_cast<Bytef const*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(crc));
}

std::string compressed(std::string const& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string result(size, '\0');
  int const status = compress(reinterpret_cast<Bytef*>(result.data()), &size,
                              reinterpret_cast<Bytef const*>(bytes.data()), bytes.size());
  if (status != Z_OK) throw std::bad_alloc();  // the only possible error, since the buffer is large enough
  result.resize(size);
  return result;
}

}  // namespace

Image<double> read_image(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] { return Picture(path).read_only_page(metadata, read_grey_levels); });
}

StoredLevels read_levels(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] { return Picture(path).read_only_page(metadata, read_stored_levels); });
}

Image<std::uint16_t> integer_levels(StoredLevels levels) {
  if (auto* const integers = std::get_if<Image<std::uint16_t>>(&levels)) return std::move(*integers);
  return integer_levels(std::get<Image<double>>(levels));
}

FramePair<double> read_frame_pair(std::string const& path, ImageMetadata* metadata) {
  return named(path, [&] {
    Picture picture(path);
    if (picture.pages() != 2) {
      throw DataError(
          ErrorCode::wrong_shape, path,
          fmt::format(
              "has {} {}, but a single input file needs two: reference and flow; give two images, or a case folder",
              picture.pages(), picture.pages() == 1 ? "page" : "pages"));
    }
    Image<double> reference = picture.read(0, metadata);
    return FramePair<double>{std::move(reference), picture.read(1, nullptr)};
  });
}

ImagePages::ImagePages(std::string const& path) : path_(path) {
  named(path, [&] {
    Picture const picture(path);
    if (picture.has_more_pages()) {
      throw DataError(
          ErrorCode::out_of_range, path,
          fmt::format("has more than {} pages (which is the limit{}); write its pages to several files",
                      picture.most_pages(), picture.most_pages() == max_pages ? "" : " of this format or compression"));
    }
    file_size_ = picture.file_size();
    pages_ = picture.locations();
    is_cut_short_ = picture.is_cut_short();
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
  return named(path_, [&] {
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

std::size_t count_not_finite(Image<double> const& image) {
  return static_cast<std::size_t>(
      std::count_if(image.begin(), image.end(), [](double value) { return !std::isfinite(value); }));
}

void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata) {
  GreyPage page{image.columns(), image.rows(), image.data(), image_description(metadata),
                "gladstone " + std::string(version)};
  if (metadata.pixel_pitch_m > 0.0) page.pixels_per_centimetre = 0.01 / metadata.pixel_pitch_m;

  // Encode in memory first, since libtiff does not report a full disk.
  std::vector<unsigned char> const bytes = named(path, [&] { return encode_tiff(path, page); });
  OutputFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

// PNG specification (W3C 2003, ISO/IEC 15948). Rows are not filtered: dots compress by 15 % better than their
// differences.
std::string encode_png(Image<std::uint8_t> const& image) {
  constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
  constexpr std::string_view grey_8_bit{"\x08\0\0\0\0", 5};  // bits, colour type, compression, filter, interlacing
  auto const columns = static_cast<std::size_t>(image.columns());
  std::string rows;
  for (int row = 0; row < image.rows(); ++row) {
    rows += '\0';  // filter of the row: none
    rows.append(reinterpret_cast<char const*>(image.data()) + static_cast<std::size_t>(row) * columns, columns);
  }
  return std::string(signature) +
         png_chunk("IHDR", big_endian(static_cast<std::uint32_t>(columns)) +
                               big_endian(static_cast<std::uint32_t>(image.rows())) + std::string(grey_8_bit)) +
         png_chunk("IDAT", compressed(rows)) + png_chunk("IEND", "");
}

}  // namespace gladstone::inline files
