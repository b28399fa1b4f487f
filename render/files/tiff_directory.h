#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "render/base/image.h"
#include "render/files/input_file.h"

namespace gladstone {

/// Tags of TIFF 6.0 (Adobe 1992, section 8) that are evaluated.
enum class TiffTag : std::uint16_t {
  width = 256,
  height = 257,
  bits_per_sample = 258,
  compression = 259,
  photometric = 262,
  fill_order = 266,
  strip_offsets = 273,
  samples_per_pixel = 277,
  rows_per_strip = 278,
  strip_byte_counts = 279,
  sample_format = 339,
};

/// Integer entries of one page (image file directory) of a TIFF.
class TiffDirectory {
 public:
  using Entries = std::map<std::uint16_t, std::vector<std::uint64_t>>;
  explicit TiffDirectory(Entries entries) : entries_(std::move(entries)) {}

  bool has(TiffTag tag) const { return entries_.contains(static_cast<std::uint16_t>(tag)); }
  /// Returns all values of an entry; empty if it is missing.
  std::vector<std::uint64_t> values(TiffTag tag) const;
  /// Returns the first value of an entry, or `otherwise` if it is missing.
  std::uint64_t value(TiffTag tag, std::uint64_t otherwise) const;

 private:
  Entries entries_;
};

/// Reads the directories of a TIFF or BigTIFF of either byte order.
/// @return one directory per page, up to the first damaged one or max_pages; empty if the file is not a TIFF
std::vector<TiffDirectory> read_tiff_directories(InputFile const& file, std::size_t max_pages);

/// Reads an uncompressed page of one bit per pixel as 0 (black) and 1 (white).
/// @throws DataError if it is compressed or truncated
Image<double> read_bilevel_page(InputFile const& file, TiffDirectory const& page);

}  // namespace gladstone
