#include "render/files/tiff_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "render/base/available_memory.h"
#include "render/base/error.h"

namespace gladstone {
namespace {

constexpr std::uint64_t max_values = 1u << 20;  // limit on the values of an entry
constexpr std::uint64_t max_entries = 4096;     // limit on the entries of a directory
constexpr int uncompressed = 1;
constexpr std::size_t bits_in_byte = 8;

/// Reads integers in the byte order of the file; 0 beyond its end.
struct NumberReader {
  InputFile const& file;
  bool big_endian = false;

  std::uint64_t number(std::uint64_t offset, std::size_t size) const {
    std::array<unsigned char, 8> bytes{};
    if (offset < file.size()) file.read(offset, bytes.data(), size);
    return decode(bytes.data(), size);
  }
  std::uint64_t decode(unsigned char const* bytes, std::size_t size) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | bytes[big_endian ? i : size - 1 - i];
    return value;
  }
};

/// Sizes of the parts of a directory in TIFF and BigTIFF [bytes].
struct Layout {
  std::size_t count_bytes, entry_bytes, offset_bytes;
};
constexpr Layout classic{2, 12, 4}, big{8, 20, 8};

bool is_read(std::uint16_t tag) {
  using enum TiffTag;
  constexpr std::array read{width,        height,        bits_per_sample,   compression,    photometric,
                            fill_order,   strip_offsets, samples_per_pixel, rows_per_strip, strip_byte_counts,
                            sample_format};
  return std::find(read.begin(), read.end(), static_cast<TiffTag>(tag)) != read.end();
}

/// Returns the size of an integer type of TIFF [bytes] (TIFF 6.0, section 2); 0 for other types.
std::size_t integer_bytes(std::uint64_t type) {
  switch (type) {
    case 1:
      return 1;
    case 3:
      return 2;
    case 4:
      return 4;
    case 16:
      return 8;
    default:
      return 0;
  }
}

/// Reads the values of an entry at offset `entry`; empty if they are not integers or lie beyond the end of the file.
std::vector<std::uint64_t> entry_values(NumberReader const& reader, Layout const& layout, std::uint64_t entry) {
  std::size_t const size = integer_bytes(reader.number(entry + 2, 2));
  std::uint64_t const count = reader.number(entry + 4, layout.offset_bytes);
  std::uint64_t const inside = entry + 4 + layout.offset_bytes;
  if (size == 0 || count > max_values) return {};
  std::uint64_t const start = count * size > layout.offset_bytes ? reader.number(inside, layout.offset_bytes) : inside;
  std::vector<unsigned char> bytes(count * size);
  if (start >= reader.file.size() || reader.file.read(start, bytes.data(), bytes.size()) < bytes.size()) return {};
  std::vector<std::uint64_t> values;
  for (std::uint64_t i = 0; i < count; ++i) values.push_back(reader.decode(bytes.data() + i * size, size));
  return values;
}

/// Returns bit `column` of a packed row. @param reversed  FillOrder 2: least significant bit first
bool bit_of(unsigned char const* row, std::size_t column, bool reversed) {
  std::size_t const within = column % bits_in_byte, shift = reversed ? within : bits_in_byte - 1 - within;
  return (row[column / bits_in_byte] >> shift & 1) != 0;
}

}  // namespace

std::vector<std::uint64_t> TiffDirectory::values(TiffTag tag) const {
  auto const entry = entries_.find(static_cast<std::uint16_t>(tag));
  return entry == entries_.end() ? std::vector<std::uint64_t>{} : entry->second;
}

std::uint64_t TiffDirectory::value(TiffTag tag, std::uint64_t otherwise) const {
  std::vector<std::uint64_t> const all = values(tag);
  return all.empty() ? otherwise : all.front();
}

std::vector<TiffDirectory> read_tiff_directories(InputFile const& file, std::size_t max_pages) {
  std::vector<TiffDirectory> directories;
  NumberReader reader{file};
  std::uint64_t const mark = reader.number(0, 2);
  if (mark != 0x4949 && mark != 0x4d4d) return directories;
  reader.big_endian = mark == 0x4d4d;
  std::uint64_t const version = reader.number(2, 2);
  if (version != 42 && version != 43) return directories;
  Layout const& layout = version == 42 ? classic : big;
  std::uint64_t directory = reader.number(version == 42 ? 4 : 8, layout.offset_bytes);
  while (directory != 0 && directory < file.size() && directories.size() < max_pages) {
    std::uint64_t const count = reader.number(directory, layout.count_bytes);
    std::uint64_t const first = directory + layout.count_bytes;
    if (count > max_entries || first + count * layout.entry_bytes > file.size()) break;
    TiffDirectory::Entries entries;
    for (std::uint64_t i = 0; i < count; ++i) {
      std::uint64_t const entry = first + i * layout.entry_bytes;
      auto const tag = static_cast<std::uint16_t>(reader.number(entry, 2));
      if (is_read(tag)) entries[tag] = entry_values(reader, layout, entry);
    }
    directories.emplace_back(std::move(entries));
    directory = reader.number(first + count * layout.entry_bytes, layout.offset_bytes);
  }
  return directories;
}

Image<double> read_bilevel_page(InputFile const& file, TiffDirectory const& page) {
  std::uint64_t const columns = page.value(TiffTag::width, 0), rows = page.value(TiffTag::height, 0);
  std::vector<std::uint64_t> const offsets = page.values(TiffTag::strip_offsets),
                                   sizes = page.values(TiffTag::strip_byte_counts);
  if (page.value(TiffTag::compression, uncompressed) != uncompressed || offsets.empty() ||
      page.value(TiffTag::samples_per_pixel, 1) != 1) {
    throw DataError(file.path(),
                    "has one bit per pixel by default (its entry BitsPerSample is missing), which is supported only in "
                    "uncompressed strips; write it with 8 bits per pixel");
  }
  std::uint64_t const row_bytes = (columns + bits_in_byte - 1) / bits_in_byte;
  std::uint64_t const strip_rows = std::min(page.value(TiffTag::rows_per_strip, rows), rows);
  auto const cut_short = [&] {
    return DataError(file.path(), fmt::format("is damaged or cut short: its header declares {} x {} px of one bit, but "
                                              "the file has {} bytes; copy it again",
                                              columns, rows, file.size()));
  };
  constexpr std::uint64_t max_side = 1u << 20;
  if (columns == 0 || rows == 0 || columns > max_side || rows > max_side || row_bytes * rows > file.size() ||
      strip_rows == 0 || offsets.size() < (rows + strip_rows - 1) / strip_rows ||
      (!sizes.empty() && sizes.size() < offsets.size())) {
    throw cut_short();
  }
  require_memory(file.path(), fmt::format("an image of {} x {} px", columns, rows),
                 static_cast<double>(columns * rows) * sizeof(double));
  bool const inverted = page.value(TiffTag::photometric, 1) == 0, reversed = page.value(TiffTag::fill_order, 1) == 2;
  Image<double> image(static_cast<int>(columns), static_cast<int>(rows));
  std::vector<unsigned char> packed(row_bytes);
  for (std::uint64_t row = 0; row < rows; ++row) {
    std::uint64_t const offset = offsets[row / strip_rows] + row % strip_rows * row_bytes;
    if (file.read(offset, packed.data(), packed.size()) < packed.size()) throw cut_short();
    for (std::uint64_t column = 0; column < columns; ++column) {
      bool const white = bit_of(packed.data(), column, reversed) != inverted;
      image(static_cast<int>(column), static_cast<int>(row)) = white ? 1.0 : 0.0;
    }
  }
  return image;
}

}  // namespace gladstone
