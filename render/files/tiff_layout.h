#pragma once

#include <cstdint>

#include "render/files/image_codecs.h"
#include "render/files/tiff_stream.h"

/// Helpers of tiff_reader.cpp; not for other files.
namespace gladstone::inline files {

/// Storage of the samples of one TIFF page in blocks (tiles or strips). A block has whole rows of packed samples, each
/// row beginning at a byte.
struct TiffLayout {
  std::uint32_t columns = 0, rows = 0;  ///< size of the page [px]
  std::uint16_t channels = 1;
  std::uint16_t bits = 1;          ///< bits per stored sample
  std::uint64_t sample_bytes = 0;  ///< size of a sample as read [bytes]; 0 if this type is not read
  bool tiled = false;
  bool separate = false;         ///< each block contains the samples of one channel (PlanarConfiguration = 2)
  bool white_is_zero = false;    ///< unsigned integers with PhotometricInterpretation = WhiteIsZero
  bool decodable = false;        ///< libtiff decodes this layout to samples of grey levels, RGB or inks
  bool bits_are_stored = false;  ///< entry BitsPerSample is present; its default is 1
  std::uint32_t block_columns = 0, block_rows = 0;  ///< size of a block [px]

  /// Returns true if a decoded block is a part of the image: whole rows of samples with all their bits.
  bool is_contiguous() const { return !tiled && !separate && bits == 8 * sample_bytes; }
};

/// Determines the layout of the current page.
TiffLayout read_tiff_layout(tiff* handle);

/// Returns the header of the current page. White is the larger value, whatever the page says.
PageHeader read_tiff_header(tiff* handle, TiffLayout const& layout);

}  // namespace gladstone::inline files
