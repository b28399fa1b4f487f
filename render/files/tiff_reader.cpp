#include "render/files/tiff_reader.h"

#include <fmt/format.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "render/base/error.h"
#include "render/files/tiff_layout.h"
#include "render/files/tiff_stream.h"

namespace gladstone::inline files {
namespace {

constexpr std::uint32_t bits_in_byte = 8;

/// File open for reading, which may begin with any of its pages: libtiff then reads a header with the offset of that
/// page's directory in place of the first one.
class FileStream final : public TiffStream {
 public:
  explicit FileStream(InputFile const& file) : file_(file) {}
  FileStream(InputFile const& file, std::uint64_t directory) : file_(file) {
    constexpr unsigned char big_tiff = 43;
    header_.resize(16);
    header_.resize(file.read(0, header_.data(), header_.size()));
    if (header_.size() < 16) return;
    bool const little_endian = header_[0] == 'I';
    bool const big = header_[little_endian ? 2 : 3] == big_tiff;
    std::size_t const first = big ? 8 : 4, size = first;  // position and size of the offset in the header
    for (std::size_t i = 0; i < size; ++i)
      header_[first + (little_endian ? i : size - 1 - i)] = static_cast<unsigned char>(directory >> (bits_in_byte * i));
  }
  /// Opens the TIFF without mapping it into memory ('m') and without dividing its strips ('c').
  TiffHandle open_file() { return open(file_.path(), "rmc"); }

 private:
  std::size_t read(std::uint64_t offset, void* to, std::size_t size) override {
    if (offset >= file_.size()) return 0;
    std::size_t const count = file_.read(offset, to, size);
    auto* const bytes = static_cast<unsigned char*>(to);
    for (std::uint64_t i = offset; i < std::min<std::uint64_t>(offset + count, header_.size()); ++i)
      bytes[i - offset] = header_[i];
    return count;
  }
  void write(std::uint64_t, void const*, std::size_t) override {}
  std::uint64_t size() const override { return file_.size(); }

  InputFile const& file_;
  std::vector<unsigned char> header_;  ///< bytes that replace the first ones of the file
};

/// Copies `count` packed samples of a row into every `stride`-th sample of `samples`. A sample of fewer bits than its
/// type fills the upper bits of it.
template <class Sample>
void unpack(unsigned char const* packed, std::uint32_t bits, std::size_t count, std::size_t stride, void* samples) {
  auto* const to = static_cast<unsigned char*>(samples);
  constexpr std::size_t size = sizeof(Sample);
  if (bits == bits_in_byte * size) {
    for (std::size_t i = 0; i < count; ++i) std::memcpy(to + i * stride * size, packed + i * size, size);
    return;
  }
  std::uint32_t buffer = 0, available = 0;  // bits of the row that have been fetched, the latest ones lowest
  for (std::size_t i = 0; i < count; ++i) {
    for (; available < bits; available += bits_in_byte) buffer = buffer << bits_in_byte | *packed++;
    available -= bits;
    std::uint32_t const value = buffer >> available & ((std::uint32_t{1} << bits) - 1);
    auto const sample = static_cast<Sample>(value << (bits_in_byte * size - bits));
    std::memcpy(to + i * stride * size, &sample, size);
  }
}

void unpack(TiffLayout const& layout, unsigned char const* packed, std::size_t count, std::size_t stride,
            void* samples) {
  switch (layout.sample_bytes) {
    case 1:
      return unpack<std::uint8_t>(packed, layout.bits, count, stride, samples);
    case 2:
      return unpack<std::uint16_t>(packed, layout.bits, count, stride, samples);
    case 4:
      return unpack<std::uint32_t>(packed, layout.bits, count, stride, samples);
    default:
      return unpack<std::uint64_t>(packed, layout.bits, count, stride, samples);
  }
}

class TiffReader final : public TiffPageReader {
 public:
  /// @param first  arguments of FileStream
  template <class... First>
  explicit TiffReader(First const&... first) : stream_(first...), handle_(stream_.open_file()) {
    stream_.check_error();
    if (!handle_) return;
    page_ = 0;
    layout_ = read_tiff_layout(handle_.get());
  }

  /// Returns true if libtiff decodes all pages that are not previews.
  bool is_decodable(InputFile const& file) {
    if (!handle_) return false;
    TiffLayout const first = layout_;
    bool decodable = true;
    for (int page = 0; decodable && page < max_pages && seek(page); ++page) {
      if (layout_.columns < first.columns && layout_.rows < first.rows) continue;
      decodable = layout_.decodable;
      if (!decodable && !layout_.bits_are_stored) {
        throw DataError(ErrorCode::unsupported, file.path(),
                        "has one bit per pixel by default (its entry BitsPerSample is missing), which is read as grey "
                        "levels only; write it with 8 bits per pixel");
      }
    }
    return seek(0) && decodable;
  }

  bool seek(int page) override {
    if (page == page_) return true;
    bool const declared = page == page_ + 1 && TIFFLastDirectory(handle_.get()) == 0;
    int const found = page == page_ + 1 ? TIFFReadDirectory(handle_.get())
                                        : TIFFSetDirectory(handle_.get(), static_cast<tdir_t>(page));
    stream_.check_error();
    page_ = found == 1 ? page : no_page;
    cut_short_ = declared && found != 1;
    if (found == 1) layout_ = read_tiff_layout(handle_.get());
    return found == 1;
  }

  /// Returns true if libtiff decodes the current page.
  bool decodes_page() const { return page_ != no_page && layout_.decodable; }

  std::uint64_t directory() const override { return TIFFCurrentDirOffset(handle_.get()); }

  bool is_cut_short() const override { return cut_short_; }

  PageHeader header() const override { return read_tiff_header(handle_.get(), layout_); }

  std::string read(void* samples) override {
    auto* const bytes = static_cast<unsigned char*>(samples);
    bool const decoded = layout_.is_contiguous() ? read_strips(bytes) : read_blocks(bytes);
    std::string const error = stream_.check_error();
    if (!decoded || !error.empty()) return error.empty() ? "no reason given" : error.substr(0, error.find('\n'));
    if (layout_.white_is_zero) {
      std::uint64_t const size =
          std::uint64_t{layout_.columns} * layout_.rows * layout_.channels * layout_.sample_bytes;
      std::transform(bytes, bytes + size, bytes, [](unsigned char byte) { return static_cast<unsigned char>(~byte); });
    }
    return "";
  }

  void clear_errors() override { stream_.check_error(); }

 private:
  static constexpr int no_page = -2;

  /// Decodes whole strips into the image.
  bool read_strips(unsigned char* samples) {
    std::uint64_t const row_bytes = std::uint64_t{layout_.columns} * layout_.channels * layout_.sample_bytes;
    std::uint32_t strip = 0;
    for (std::uint64_t row = 0; row < layout_.rows; row += layout_.block_rows, ++strip) {
      auto const size =
          static_cast<tmsize_t>(std::min<std::uint64_t>(layout_.block_rows, layout_.rows - row) * row_bytes);
      if (TIFFReadEncodedStrip(handle_.get(), strip, samples + row * row_bytes, size) != size) return false;
    }
    return true;
  }

  /// Decodes tiles or strips one by one into a buffer, and unpacks their rows into the image.
  bool read_blocks(unsigned char* samples) {
    tmsize_t const row_bytes = layout_.tiled ? TIFFTileRowSize(handle_.get()) : TIFFScanlineSize(handle_.get());
    tmsize_t const block_bytes = layout_.tiled ? TIFFTileSize(handle_.get()) : TIFFStripSize(handle_.get());
    if (row_bytes <= 0 || block_bytes <= 0) return false;
    auto const buffer = std::make_unique_for_overwrite<unsigned char[]>(static_cast<std::size_t>(block_bytes));
    std::uint16_t const planes = layout_.separate ? layout_.channels : 1;
    for (std::uint16_t plane = 0; plane < planes; ++plane) {
      for (std::uint64_t y = 0; y < layout_.rows; y += layout_.block_rows) {
        for (std::uint64_t x = 0; x < layout_.columns; x += layout_.block_columns) {
          if (!decode_block(x, y, plane, buffer.get())) return false;
          unpack_block(x, y, plane, buffer.get(), static_cast<std::size_t>(row_bytes), samples);
        }
      }
    }
    return true;
  }

  bool decode_block(std::uint64_t x, std::uint64_t y, std::uint16_t plane, void* buffer) {
    auto const column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
    if (layout_.tiled) {
      tmsize_t const size = TIFFTileSize(handle_.get());
      std::uint32_t const tile = TIFFComputeTile(handle_.get(), column, row, 0, plane);
      return TIFFReadEncodedTile(handle_.get(), tile, buffer, size) == size;
    }
    tmsize_t const size = TIFFVStripSize(handle_.get(), std::min(layout_.block_rows, layout_.rows - row));
    return TIFFReadEncodedStrip(handle_.get(), TIFFComputeStrip(handle_.get(), row, plane), buffer, size) == size;
  }

  /// Unpacks the part of a block that lies in the image.
  void unpack_block(std::uint64_t x, std::uint64_t y, std::uint16_t plane, unsigned char const* block,
                    std::size_t row_bytes, unsigned char* samples) const {
    std::size_t const stride = layout_.separate ? layout_.channels : 1;
    std::size_t const count =
        std::min<std::size_t>(layout_.block_columns, layout_.columns - x) * (layout_.separate ? 1 : layout_.channels);
    std::size_t const rows = std::min<std::size_t>(layout_.block_rows, layout_.rows - y);
    for (std::size_t row = 0; row < rows; ++row) {
      std::size_t const first = ((y + row) * layout_.columns + x) * layout_.channels + plane;
      unpack(layout_, block + row * row_bytes, count, stride, samples + first * layout_.sample_bytes);
    }
  }

  FileStream stream_;
  TiffHandle handle_;
  int page_ = no_page;
  bool cut_short_ = false;  // the page of the last seek() is declared, but cannot be read
  TiffLayout layout_;       ///< layout of the current page
};

}  // namespace

std::unique_ptr<TiffPageReader> open_tiff(InputFile const& file) {
  auto reader = std::make_unique<TiffReader>(file);
  return reader->is_decodable(file) ? std::move(reader) : nullptr;
}

std::unique_ptr<PageReader> open_tiff_page(InputFile const& file, std::uint64_t directory) {
  auto reader = std::make_unique<TiffReader>(file, directory);
  return reader->decodes_page() ? std::move(reader) : nullptr;
}

std::string describe_tiff_samples(InputFile const& file) {
  FileStream stream(file);
  TiffHandle const handle = stream.open_file();
  stream.check_error();
  if (!handle) return "";
  constexpr std::array<char const*, 7> formats{"unknown numbers",
                                               "unsigned integers",
                                               "signed integers",
                                               "floating-point numbers",
                                               "undefined values",
                                               "complex integers",
                                               "complex floating-point numbers"};
  std::uint16_t format = SAMPLEFORMAT_UINT, bits = 1, compression = COMPRESSION_NONE;
  TIFFGetFieldDefaulted(handle.get(), TIFFTAG_SAMPLEFORMAT, &format);
  TIFFGetFieldDefaulted(handle.get(), TIFFTAG_BITSPERSAMPLE, &bits);
  TIFFGetFieldDefaulted(handle.get(), TIFFTAG_COMPRESSION, &compression);
  return fmt::format("{} of {} bits and compression {}", formats[format < formats.size() ? format : 0], bits,
                     compression);
}

}  // namespace gladstone::inline files
