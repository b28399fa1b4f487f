#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

/// Interface of image readers, and of the shared library gladstone_image_codecs. OpenImageIO loads about 250 other
/// libraries; a separate library avoids this in programs that read and write no other images than TIFFs
/// (tiff_reader.h). The functions of that library do not throw.
namespace gladstone::inline files {

/// Type of a sample in memory.
enum class SampleType { other, uint8, uint16, int16, uint32, int32, float32, float64 };

/// Meaning of the channels of a page.
enum class Colours {
  by_count,  ///< one or two channels: grey; three or more: red, green and blue
  grey,      ///< one grey level, whatever the number of channels
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
  double pixel_bits = 0.0;              ///< lower limit on the stored bits per pixel before compression
  std::string compression = "unknown";  ///< name of the compression method, "none" if uncompressed
  std::array<double, 3> tile_px{};      ///< size of the tiles or strips that are decoded into a buffer along x, y and
                                        ///< z [px]; 0 if there is no such buffer
  std::string description;              ///< text of the entry ImageDescription
  float resolution = 0.0f;              ///< value of the entry XResolution [pixels per resolution_unit]
  std::string resolution_unit;          ///< "cm", "in", or "" if not specified
  int orientation = 1;                  ///< orientation of the stored image, 1 to 8 (TIFF 6.0, EXIF)
  Colours colours = Colours::by_count;
};

/// Maximum number of pages of a TIFF that are examined (libtiff: 1048576).
inline constexpr int max_pages = 1'000'000;
/// Maximum number of pages of other files, whose readers count from the first page to find another one.
inline constexpr int max_codec_pages = 1000;

/// Open image file, positioned at one of its pages.
class PageReader {
 public:
  virtual ~PageReader() = default;
  /// Moves to a page, counted from 0. @return false if it does not exist
  virtual bool seek(int page) = 0;
  /// Returns true if the last seek() failed for a page that the file declares, for example because it is cut short.
  virtual bool is_cut_short() const { return false; }
  virtual PageHeader header() const = 0;
  /// Reads all samples of the page as an array of rows x columns x channels of the header's sample type. Unsigned
  /// samples of fewer bits than their type are scaled to its range, so that their upper bits are the stored value. If
  /// zero is white in the file, unsigned samples are inverted.
  /// @return empty on success, else the codec library's error message
  virtual std::string read(void* samples) = 0;
  /// Clears the pending error messages of the codec library.
  virtual void clear_errors() = 0;
};

class ImageCodecs {
 public:
  virtual ~ImageCodecs() = default;
  /// Opens an image file. @return nullptr if no reader accepts the file
  virtual std::unique_ptr<PageReader> open(std::string const& path) const = 0;
};

/// Returns the image codecs; the first call loads libgladstone_image_codecs.so from the directory in the environment
/// variable GLADSTONE_IMAGE_CODECS, or else along the program's run path.
/// @throws DataError if the library cannot be loaded, or (code `memory`) if too little address space is available
ImageCodecs const& loaded_image_codecs();

/// Name of the function that the library exports. Its number changes with this interface, so that a library of another
/// version is refused.
inline constexpr char const* image_codecs_entry = "gladstone_image_codecs_3";
/// Type of this function.
using ImageCodecsEntry = ImageCodecs const* (*)();

}  // namespace gladstone::inline files
