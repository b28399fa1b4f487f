#include "render/files/tiff_layout.h"

#include <tiffio.h>

#include <algorithm>

namespace gladstone::inline files {
namespace {

/// Returns the first value of an entry, its default, or `otherwise` if it has no default.
template <class Value>
Value tag_value(TIFF* handle, std::uint32_t tag, Value otherwise) {
  Value value = otherwise;
  return TIFFGetFieldDefaulted(handle, tag, &value) == 1 ? value : otherwise;
}

/// Returns true if libtiff decodes the compression method to samples of the page's colours. LogLuv, old-style JPEG and
/// Pixar's methods need a conversion.
bool is_decoded(std::uint16_t compression) {
  switch (compression) {
    case COMPRESSION_NONE:
    case COMPRESSION_CCITTRLE:
    case COMPRESSION_CCITTRLEW:
    case COMPRESSION_CCITTFAX3:
    case COMPRESSION_CCITTFAX4:
    case COMPRESSION_LZW:
    case COMPRESSION_JPEG:
    case COMPRESSION_ADOBE_DEFLATE:
    case COMPRESSION_DEFLATE:
    case COMPRESSION_PACKBITS:
    case COMPRESSION_LZMA:
    case COMPRESSION_ZSTD:
    case COMPRESSION_WEBP:
    case COMPRESSION_LERC:
      return TIFFIsCODECConfigured(compression) == 1;
    default:
      return false;
  }
}

SampleType sample_type(std::uint16_t format, std::uint16_t bits) {
  if (format == SAMPLEFORMAT_UINT) {
    if (bits >= 1 && bits <= 16) return bits <= 8 ? SampleType::uint8 : SampleType::uint16;
    if (bits == 32) return SampleType::uint32;
  }
  if (format == SAMPLEFORMAT_INT && bits == 16) return SampleType::int16;
  if (format == SAMPLEFORMAT_INT && bits == 32) return SampleType::int32;
  if (format == SAMPLEFORMAT_IEEEFP && bits == 32) return SampleType::float32;
  if (format == SAMPLEFORMAT_IEEEFP && bits == 64) return SampleType::float64;
  return SampleType::other;
}

std::uint64_t bytes_of(SampleType type) {
  switch (type) {
    case SampleType::other:
      return 0;
    case SampleType::uint8:
      return 1;
    case SampleType::uint16:
    case SampleType::int16:
      return 2;
    case SampleType::uint32:
    case SampleType::int32:
    case SampleType::float32:
      return 4;
    case SampleType::float64:
      return 8;
  }
  return 0;
}

SampleType sample_type(TIFF* handle) {
  return sample_type(tag_value<std::uint16_t>(handle, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT),
                     tag_value<std::uint16_t>(handle, TIFFTAG_BITSPERSAMPLE, 1));
}

/// Returns the PhotometricInterpretation; if it is missing, grey for one channel and RGB for several.
std::uint16_t photometric(TIFF* handle, std::uint16_t channels) {
  std::uint16_t value = channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
  TIFFGetField(handle, TIFFTAG_PHOTOMETRIC, &value);
  return value;
}

bool is_decodable(TIFF* handle, TiffLayout const& layout) {
  constexpr std::uint16_t rgb_channels = 3;
  std::uint16_t const colours = photometric(handle, layout.channels);
  bool const known_colours = colours == PHOTOMETRIC_MINISBLACK || colours == PHOTOMETRIC_MINISWHITE ||
                             colours == PHOTOMETRIC_SEPARATED ||
                             (colours == PHOTOMETRIC_RGB && layout.channels >= rgb_channels);
  bool const flat = tag_value<std::uint32_t>(handle, TIFFTAG_IMAGEDEPTH, 1) == 1 &&
                    (!layout.tiled || tag_value<std::uint32_t>(handle, TIFFTAG_TILEDEPTH, 1) == 1);
  return layout.sample_bytes > 0 && layout.channels > 0 && layout.block_columns > 0 && layout.block_rows > 0 &&
         known_colours && flat && is_decoded(tag_value<std::uint16_t>(handle, TIFFTAG_COMPRESSION, COMPRESSION_NONE));
}

Colours colours_of(std::uint16_t photometric) {
  switch (photometric) {
    case PHOTOMETRIC_MINISBLACK:
    case PHOTOMETRIC_MINISWHITE:
      return Colours::grey;
    case PHOTOMETRIC_SEPARATED:
      return Colours::inks;
    default:
      return Colours::by_count;
  }
}

std::string resolution_unit(TIFF* handle) {
  std::uint16_t unit = RESUNIT_NONE;
  TIFFGetField(handle, TIFFTAG_RESOLUTIONUNIT, &unit);
  return unit == RESUNIT_CENTIMETER ? "cm" : unit == RESUNIT_INCH ? "in" : "";
}

std::string compression_name(std::uint16_t compression) {
  TIFFCodec const* const codec = TIFFFindCODEC(compression);
  return compression == COMPRESSION_NONE ? "none" : codec != nullptr ? codec->name : "unknown";
}

}  // namespace

TiffLayout read_tiff_layout(tiff* handle) {
  TiffLayout layout;
  layout.columns = tag_value<std::uint32_t>(handle, TIFFTAG_IMAGEWIDTH, 0);
  layout.rows = tag_value<std::uint32_t>(handle, TIFFTAG_IMAGELENGTH, 0);
  layout.channels = tag_value<std::uint16_t>(handle, TIFFTAG_SAMPLESPERPIXEL, 1);
  layout.bits = tag_value<std::uint16_t>(handle, TIFFTAG_BITSPERSAMPLE, 1);
  std::uint16_t stored_bits = 0;
  layout.bits_are_stored = TIFFGetField(handle, TIFFTAG_BITSPERSAMPLE, &stored_bits) == 1;
  layout.sample_bytes = bytes_of(sample_type(handle));
  layout.tiled = TIFFIsTiled(handle) != 0;
  layout.separate = layout.channels > 1 && tag_value<std::uint16_t>(handle, TIFFTAG_PLANARCONFIG,
                                                                    PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  layout.white_is_zero = photometric(handle, layout.channels) == PHOTOMETRIC_MINISWHITE &&
                         tag_value<std::uint16_t>(handle, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT) == SAMPLEFORMAT_UINT;
  if (layout.tiled) {
    layout.block_columns = tag_value<std::uint32_t>(handle, TIFFTAG_TILEWIDTH, 0);
    layout.block_rows = tag_value<std::uint32_t>(handle, TIFFTAG_TILELENGTH, 0);
  } else {
    layout.block_columns = layout.columns;
    layout.block_rows = std::min(tag_value(handle, TIFFTAG_ROWSPERSTRIP, layout.rows), layout.rows);
  }
  layout.decodable = is_decodable(handle, layout);
  return layout;
}

PageHeader read_tiff_header(tiff* handle, TiffLayout const& layout) {
  PageHeader header;
  header.width = static_cast<int>(layout.columns);
  header.height = static_cast<int>(layout.rows);
  header.channels = layout.channels;
  header.type = sample_type(handle);
  header.sample_bytes = layout.sample_bytes;
  header.bits = layout.bits;
  header.pixel_bits = static_cast<double>(layout.bits) * layout.channels;
  header.compression = compression_name(tag_value<std::uint16_t>(handle, TIFFTAG_COMPRESSION, COMPRESSION_NONE));
  if (!layout.is_contiguous()) {
    header.tile_px = {static_cast<double>(layout.block_columns), static_cast<double>(layout.block_rows), 1.0};
  }
  char const* description = nullptr;
  if (TIFFGetField(handle, TIFFTAG_IMAGEDESCRIPTION, &description) == 1 && description != nullptr)
    header.description = description;
  TIFFGetField(handle, TIFFTAG_XRESOLUTION, &header.resolution);
  header.resolution_unit = resolution_unit(handle);
  header.orientation = tag_value<std::uint16_t>(handle, TIFFTAG_ORIENTATION, 1);
  header.colours = colours_of(photometric(handle, layout.channels));
  return header;
}

}  // namespace gladstone::inline files
