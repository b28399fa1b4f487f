#include "render/files/tiff_writer.h"

#include <tiffio.h>

#include <algorithm>
#include <cstring>

#include "render/base/error.h"
#include "render/files/tiff_stream.h"

namespace gladstone::inline files {
namespace {

/// Image size from which BigTIFF is written, since offsets of 32 bits do not suffice [bytes].
constexpr std::uint64_t most_classic_bytes = std::uint64_t{4000} << 20;
constexpr int strip_rows = 32;  // rows per strip

/// File in memory.
class MemoryStream final : public TiffStream {
 public:
  explicit MemoryStream(std::size_t expected_bytes) { bytes_.reserve(expected_bytes); }
  std::vector<unsigned char> release() { return std::move(bytes_); }

 private:
  std::size_t read(std::uint64_t offset, void* to, std::size_t size) override {
    if (offset >= bytes_.size()) return 0;
    std::size_t const available = std::min<std::size_t>(size, bytes_.size() - offset);
    std::memcpy(to, bytes_.data() + offset, available);
    return available;
  }
  void write(std::uint64_t offset, void const* from, std::size_t size) override {
    auto const* const source = static_cast<unsigned char const*>(from);
    if (offset == bytes_.size()) {
      bytes_.insert(bytes_.end(), source, source + size);
      return;
    }
    if (offset + size > bytes_.size()) bytes_.resize(offset + size);
    std::copy(source, source + size, bytes_.data() + offset);
  }
  std::uint64_t size() const override { return bytes_.size(); }

  std::vector<unsigned char> bytes_;
};

void set_tags(TIFF* handle, GreyPage const& page) {
  TIFFSetField(handle, TIFFTAG_IMAGEWIDTH, page.columns);
  TIFFSetField(handle, TIFFTAG_IMAGELENGTH, page.rows);
  TIFFSetField(handle, TIFFTAG_ROWSPERSTRIP, strip_rows);
  TIFFSetField(handle, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(handle, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(handle, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  TIFFSetField(handle, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(handle, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  TIFFSetField(handle, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(handle, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(handle, TIFFTAG_IMAGEDESCRIPTION, page.description.c_str());
  TIFFSetField(handle, TIFFTAG_SOFTWARE, page.software.c_str());
  if (page.pixels_per_centimetre > 0.0) {
    TIFFSetField(handle, TIFFTAG_XRESOLUTION, page.pixels_per_centimetre);
    TIFFSetField(handle, TIFFTAG_YRESOLUTION, page.pixels_per_centimetre);
    TIFFSetField(handle, TIFFTAG_RESOLUTIONUNIT, RESUNIT_CENTIMETER);
  }
}

bool write_strips(TIFF* handle, GreyPage const& page) {
  auto const columns = static_cast<std::size_t>(page.columns);
  for (int row = 0; row < page.rows; row += strip_rows) {
    auto const rows = static_cast<std::size_t>(std::min(strip_rows, page.rows - row));
    // libtiff swaps bytes in its argument if the file has another byte order, which mode "w" excludes
    auto* const values = const_cast<std::uint16_t*>(page.values + static_cast<std::size_t>(row) * columns);
    auto const bytes = static_cast<tmsize_t>(rows * columns * sizeof(std::uint16_t));
    if (TIFFWriteEncodedStrip(handle, static_cast<std::uint32_t>(row / strip_rows), values, bytes) != bytes)
      return false;
  }
  return true;
}

}  // namespace

std::vector<unsigned char> encode_tiff(std::string const& path, GreyPage const& page) {
  auto const fail = [&path](std::string const& reason) {
    throw OutputError(path, "the image cannot be written (" + reason + ')');
  };
  if (page.columns <= 0 || page.rows <= 0) fail("it has no pixels");
  constexpr std::size_t directory_bytes = 1024, strip_entry_bytes = 16;
  std::size_t const pixel_bytes =
      static_cast<std::size_t>(page.columns) * static_cast<std::size_t>(page.rows) * sizeof(std::uint16_t);
  MemoryStream stream(pixel_bytes + page.description.size() + page.software.size() + directory_bytes +
                      static_cast<std::size_t>(page.rows) / strip_rows * strip_entry_bytes);
  TiffHandle handle = stream.open(path, pixel_bytes > most_classic_bytes ? "w8" : "w");
  bool written = handle != nullptr;
  if (written) {
    set_tags(handle.get(), page);
    written = write_strips(handle.get(), page);
  }
  handle.reset();  // writes the directory
  std::string const error = stream.check_error();
  if (!written || !error.empty()) fail(error.empty() ? "no reason given" : error);
  return stream.release();
}

}  // namespace gladstone::inline files
