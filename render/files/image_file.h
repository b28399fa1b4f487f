#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "render/base/frame_pair.h"
#include "render/base/image.h"

namespace gladstone::inline files {

/// Metadata of an image file.
struct ImageMetadata {
  int bit_depth = 16;          ///< significant bits per pixel; values are stored unshifted in 16 bits
  double pixel_pitch_m = 0.0;  ///< pixel pitch [m], also stored as X/YResolution; 0: unknown
  std::string description;     ///< text of the entry ImageDescription, e.g. the resolved setup
  int channels = 1;            ///< channels in the file, before conversion to grey (only set by reading)
  int sample_bits = 16;        ///< bits per sample in the file, significant or not (only set by reading)
  int orientation = 1;         ///< orientation in the file, 1 to 8 (TIFF, EXIF), before it is corrected (only set by
                               ///< reading)
};

/// Reads an image of any format that OpenImageIO supports (TIFF, PNG, JPEG, EXR; integers of 1 to 16 or 32 bits, float)
/// as unscaled grey levels: 0..255, 0..65535 or as stored.
/// - Colours, CMYK and palettes are converted to luminance (Rec. 709); an alpha channel is ignored.
/// - The entry Orientation (TIFF 6.0, section 8; EXIF) is applied: pixel (0, 0) is the upper left one as displayed.
/// - TIFFs whose zero is white (WhiteIsZero) are inverted, so that white is the larger value.
/// @throws DataError, also if the file has several pages, or channels that are neither grey levels nor colours
Image<double> read_image(std::string const& path, ImageMetadata* metadata = nullptr);

/// Grey levels as an image file stores them: integers of up to 16 bits, or real numbers where samples are of another
/// type, or colours.
using StoredLevels = std::variant<Image<std::uint16_t>, Image<double>>;

/// Reads an image as read_image() does, without converting integers of 8 or 16 bits to real numbers.
StoredLevels read_levels(std::string const& path, ImageMetadata* metadata = nullptr);

/// Returns grey levels as integers; converts those that are stored otherwise.
/// @pre all grey levels are whole numbers from 0 to 65535
Image<std::uint16_t> integer_levels(StoredLevels levels);

/// Reads a file of two pages, as written by PIV cameras: frame A and frame B. Pages smaller than the first in both
/// directions are previews, which are ignored.
/// @throws DataError if the number of pages is not two
FramePair<double> read_frame_pair(std::string const& path, ImageMetadata* metadata = nullptr);

/// Counts the pixels that are NaN or infinite, which floating-point images can contain.
std::size_t count_not_finite(Image<double> const& image);

/// Writes a 16-bit grey TIFF; the file appears under its name when complete. @throws OutputError
void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata);

/// Encodes an image as an 8-bit grey PNG.
std::string encode_png(Image<std::uint8_t> const& image);

}  // namespace gladstone::inline files
