#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "render/files/image_codecs.h"
#include "render/files/input_file.h"

/// TIFF files through libtiff, without the 250 libraries that OpenImageIO loads.
namespace gladstone::inline files {

/// Reader of a TIFF.
class TiffPageReader : public PageReader {
 public:
  /// Returns the offset of the current page's directory in the file, by which open_tiff_page() finds the page [bytes].
  virtual std::uint64_t directory() const = 0;
};

/// Opens a TIFF or BigTIFF whose pages store grey levels, RGB colours or printing inks:
/// - unsigned integers of 1 to 16 or 32 bits, signed integers of 16 or 32 bits, floats of 32 or 64 bits,
/// - in strips or tiles, with interleaved or separate channels,
/// - uncompressed, or compressed by LZW, deflate, PackBits, LZMA, Zstandard, LERC, WebP, CCITT (groups 3 and 4) or JPEG
///   without a conversion to YCbCr.
/// Pages smaller than the first one in both directions are previews, whose layout does not matter.
/// @param file  must outlive the returned reader, whose functions throw what InputFile::read() throws
/// @return nullptr if the file is not such a TIFF; OpenImageIO may read it
/// @throws DataError if BitsPerSample is missing in a page that libtiff does not decode: OpenImageIO 2.4 assumes 8
///         bits instead of 1
std::unique_ptr<TiffPageReader> open_tiff(InputFile const& file);

/// Opens one page of a TIFF that open_tiff() accepts as page 0, without reading the directories of the pages before it.
/// @param directory  TiffPageReader::directory() of the page
/// @return nullptr if the page cannot be read
std::unique_ptr<PageReader> open_tiff_page(InputFile const& file, std::uint64_t directory);

/// Describes the samples of the first page of a TIFF, for error messages: "unsigned integers of 64 bits and compression
/// 1". Empty if libtiff cannot open the file.
std::string describe_tiff_samples(InputFile const& file);

}  // namespace gladstone::inline files
