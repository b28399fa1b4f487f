#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "render/base/image.h"

namespace gladstone {

/// What a TIFF of ours says about itself.
struct ImageMetadata {
  int bit_depth = 16;          ///< significant bits; values are stored unshifted in 16
  double pixel_pitch_m = 0.0;  ///< also as X/YResolution
  std::string description;     ///< e.g. the resolved setup, as ImageDescription
  int channels = 1;            ///< as read: of three or more read_image made grey values
  int sample_bits = 16;        ///< as read: of a sample in the file, significant or not
  int orientation = 1;         ///< as read: TIFF's and EXIF's number, 1 to 8; read_image turned the picture upright
};

/// Reads any picture that OpenImageIO knows (TIFF, PNG, JPEG, EXR; 1 to 16 bits, float) as raw values in double:
/// 0..255, 0..65535 or as stored.
/// - Colours, printing inks and palettes become luminance (Rec. 709); an alpha channel is ignored.
/// - The entry Orientation (TIFF 6.0, section 8; EXIF) is applied: pixel (0, 0) is the upper left one as seen.
/// - White is the larger value where a TIFF has it as zero (WhiteIsZero).
/// @throws DataError, also for a file of several pages, and for channels that are neither grey nor colours
Image<double> read_image(std::string const& path, ImageMetadata* metadata = nullptr);

/// The pages of a file that holds two frames of one size, as cameras for PIV write them: reference and flow.
/// @throws DataError for another number of pages
std::array<Image<double>, 2> read_frame_pair(std::string const& path, ImageMetadata* metadata = nullptr);

/// Pixels that are nan or infinite, as pictures of floating-point numbers may have.
std::size_t count_not_finite(Image<double> const& image);

/// Writes a 16-bit grey TIFF as one whole file. @throws OutputError
void write_tiff(std::string const& path, Image<std::uint16_t> const& image, ImageMetadata const& metadata);

/// The bytes of a PNG of 8 bits. @throws DataError
std::string encode_png(Image<std::uint8_t> const& image);

}  // namespace gladstone
