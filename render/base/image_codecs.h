#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Readers and writers of pictures, in a shared library of their own: the library that knows all formats brings 250
/// others, which need not be loaded by a program that reads no picture. Nothing here throws.
namespace gladstone {

/// How a sample is stored.
enum class SampleType { other, uint8, uint16, int16, uint32, int32, float32, float64 };

/// What the channels of a page are.
enum class Colours {
  by_count,  ///< grey where they are one or two, else red, green and blue
  grey,      ///< a TIFF's BlackIsZero
  inverted,  ///< a TIFF's WhiteIsZero; samples of one byte are inverted by the library
  inks       ///< cyan, magenta, yellow and black as stored
};

/// What the header of a page says.
struct PageHeader {
  int width = 0, height = 0, depth = 1, channels = 0;
  SampleType type = SampleType::other;  ///< as it is read, not as it is stored; half floats are read as floats
  std::string type_name;
  std::uint64_t sample_bytes = 0;       ///< as read
  int bits = 0;                         ///< of a stored sample
  std::string compression = "unknown";  ///< "none", ...
  std::array<double, 3> tile_px{};      ///< size of a tile; 0 along an axis where there is none
  std::string description;              ///< ImageDescription
  float resolution = 0.0f;              ///< XResolution
  std::string resolution_unit;          ///< "cm", "in", ""
  int orientation = 1;                  ///< how the stored rows are turned, by TIFF's and EXIF's numbers 1 to 8
  Colours colours = Colours::by_count;
};

/// A picture file, open at one of its pages.
class PageReader {
 public:
  virtual ~PageReader() = default;
  virtual bool seek(int page) = 0;
  virtual PageHeader header() const = 0;
  /// Reads all samples of the page, width x height x channels of its type.
  /// @return the library's reason why they cannot be read to the end; empty: they were
  virtual std::string read(void* samples) = 0;
  /// Forgets what went wrong.
  virtual void clear_errors() = 0;
};

/// A grey picture of 16 bits to be encoded.
struct GreyPage {
  int columns = 0, rows = 0;
  std::uint16_t const* values = nullptr;
  std::string description, software;
  double pixels_per_centimetre = 0.0;  ///< 0: not said
};

class ImageCodecs {
 public:
  virtual ~ImageCodecs() = default;
  /// @return null where no format fits
  virtual std::unique_ptr<PageReader> open(std::string const& path) const = 0;
  /// A TIFF without compression and without a date. @return why it failed; empty: it did not
  virtual std::string encode_tiff(std::string const& path, GreyPage const& page,
                                  std::vector<unsigned char>& bytes) const = 0;
  /// A grey PNG of 8 bits. @return as encode_tiff
  virtual std::string encode_png(int columns, int rows, std::uint8_t const* values,
                                 std::vector<unsigned char>& bytes) const = 0;
};

/// Loads the library when it is first called: libgladstone_image_codecs.so, from the folder that GLADSTONE_IMAGE_CODECS
/// names, else where the program was built or installed to look for it. @throws DataError naming it where it is missing
ImageCodecs const& image_codecs();

/// What the library exports, under the name gladstone_image_codecs.
using ImageCodecsEntry = ImageCodecs const* (*)();

}  // namespace gladstone
