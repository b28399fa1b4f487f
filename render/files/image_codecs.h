#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// Interface of the image readers and writers in the shared library gladstone_image_codecs. OpenImageIO loads about 250
/// other libraries; a separate library avoids this in programs that read no image. The interfaces below do not throw
/// except image_codecs().
namespace gladstone {

/// Type of a sample in memory.
enum class SampleType { other, uint8, uint16, int16, uint32, int32, float32, float64 };

/// Meaning of the channels of a page.
enum class Colours {
  by_count,  ///< one or two channels: grey; three or more: red, green and blue
  grey,      ///< TIFF, BlackIsZero
  inverted,  ///< TIFF, WhiteIsZero; the codec library inverts 8-bit samples itself
  inks       ///< cyan, magenta, yellow and black, as stored
};

/// Header of a page of an image file.
struct PageHeader {
  int width = 0, height = 0, depth = 1, channels = 0;
  SampleType type = SampleType::other;  ///< type as read, which may differ from the stored one: half floats are read as
                                        ///< float
  std::string type_name;
  std::uint64_t sample_bytes = 0;       ///< size of a sample as read [bytes]
  int bits = 0;                         ///< bits per stored sample
  std::string compression = "unknown";  ///< name of the compression method, "none" if uncompressed
  std::array<double, 3> tile_px{};      ///< tile size along x, y and z [px]; 0 if not tiled
  std::string description;              ///< text of the entry ImageDescription
  float resolution = 0.0f;              ///< value of the entry XResolution [pixels per resolution_unit]
  std::string resolution_unit;          ///< "cm", "in", or "" if not specified
  int orientation = 1;                  ///< orientation of the stored image, 1 to 8 (TIFF 6.0, EXIF)
  Colours colours = Colours::by_count;
};

/// Open image file, positioned at one of its pages.
class PageReader {
 public:
  virtual ~PageReader() = default;
  /// Moves to a page, counted from 0. @return false if it does not exist
  virtual bool seek(int page) = 0;
  virtual PageHeader header() const = 0;
  /// Reads all samples of the page as an array of rows x columns x channels of the header's sample type.
  /// @return empty on success, else the codec library's error message
  virtual std::string read(void* samples) = 0;
  /// Clears the pending error messages of the codec library.
  virtual void clear_errors() = 0;
};

/// 16-bit grey image to be encoded.
struct GreyPage {
  int columns = 0, rows = 0;
  std::uint16_t const* values = nullptr;
  std::string description, software;
  double pixels_per_centimetre = 0.0;  ///< resolution, stored as X/YResolution [1/cm]; 0: not stored
};

class ImageCodecs {
 public:
  virtual ~ImageCodecs() = default;
  /// Opens an image file. @return nullptr if no reader accepts the file
  virtual std::unique_ptr<PageReader> open(std::string const& path) const = 0;
  /// Encodes an uncompressed TIFF without a date. @return empty on success, else the error message
  virtual std::string encode_tiff(std::string const& path, GreyPage const& page,
                                  std::vector<unsigned char>& bytes) const = 0;
  /// Encodes an 8-bit grey PNG. @return as encode_tiff()
  virtual std::string encode_png(int columns, int rows, std::uint8_t const* values,
                                 std::vector<unsigned char>& bytes) const = 0;
};

/// Returns the image codecs; the first call loads libgladstone_image_codecs.so from the directory in the environment
/// variable GLADSTONE_IMAGE_CODECS, or else along the program's run path.
/// @throws DataError if the library cannot be loaded, MemoryError if too little address space is available
ImageCodecs const& image_codecs();

/// Type of the function that the library exports as gladstone_image_codecs.
using ImageCodecsEntry = ImageCodecs const* (*)();

}  // namespace gladstone
