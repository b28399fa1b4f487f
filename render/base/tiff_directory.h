#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "render/base/image.h"
#include "render/base/input_file.h"

namespace gladstone {

/// Tags of TIFF 6.0 (Adobe 1992, section 8).
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

/// The integer entries of one page of a TIFF.
class TiffDirectory {
 public:
  using Entries = std::map<std::uint16_t, std::vector<std::uint64_t>>;
  explicit TiffDirectory(Entries entries) : entries_(std::move(entries)) {}

  bool has(TiffTag tag) const { return entries_.contains(static_cast<std::uint16_t>(tag)); }
  /// All values of an entry; empty where it is missing.
  std::vector<std::uint64_t> values(TiffTag tag) const;
  /// The first value of an entry.
  std::uint64_t value(TiffTag tag, std::uint64_t otherwise) const;

 private:
  Entries entries_;
};

/// Reads the directories of a TIFF or BigTIFF of either byte order.
/// @return one a page, up to the first that is damaged; empty: not a TIFF
std::vector<TiffDirectory> read_tiff_directories(InputFile const& file, std::size_t max_pages);

/// Reads a page of one bit a pixel that is stored without compression, as zeros (black) and ones (white).
/// @throws DataError where it is compressed or cut short
Image<double> read_bilevel_page(InputFile const& file, TiffDirectory const& page);

}  // namespace gladstone
