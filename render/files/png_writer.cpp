#include <zlib.h>

#include <cstdint>
#include <new>
#include <string>
#include <string_view>

#include "render/files/image_file.h"

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
