#include "render/files/image_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/base/version.h"
#include "render/files/image_description.h"
#include "render/files/image_levels.h"
#include "render/files/open_image.h"
#include "render/files/output_file.h"
#include "render/files/tiff_writer.h"

namespace gladstone::inline files {
namespace {

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
  return name_memory_error(path, [&] { return OpenImage(path).read_only_page(metadata, read_grey_levels); });
}

StoredLevels read_levels(std::string const& path, ImageMetadata* metadata) {
  return name_memory_error(path, [&] { return OpenImage(path).read_only_page(metadata, read_stored_levels); });
}

Image<std::uint16_t> integer_levels(StoredLevels levels) {
  if (auto* const integers = std::get_if<Image<std::uint16_t>>(&levels)) return std::move(*integers);
  return integer_levels(std::get<Image<double>>(levels));
}

FramePair<double> read_frame_pair(std::string const& path, ImageMetadata* metadata) {
  return name_memory_error(path, [&] {
    OpenImage image(path);
    if (image.pages() != 2) {
      throw DataError(
          ErrorCode::wrong_shape, path,
          fmt::format(
              "has {} {}, but a single input file needs two: reference and flow; give two images, or a case folder",
              image.pages(), image.pages() == 1 ? "page" : "pages"));
    }
    Image<double> reference = image.read(0, metadata);
    return FramePair<double>{std::move(reference), image.read(1, nullptr)};
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
  std::vector<unsigned char> const bytes = name_memory_error(path, [&] { return encode_tiff(path, page); });
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
