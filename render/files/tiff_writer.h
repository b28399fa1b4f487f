#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gladstone::inline files {

/// 16-bit grey image to be encoded.
struct GreyPage {
  int columns = 0, rows = 0;
  std::uint16_t const* values = nullptr;
  std::string description, software;
  double pixels_per_centimetre = 0.0;  ///< resolution, stored as X/YResolution [1/cm]; 0: not stored
};

/// Encodes an uncompressed TIFF without a date, so that equal images are equal files.
/// @param path  path of the file to be written, for error messages
/// @throws OutputError if libtiff fails, std::bad_alloc
std::vector<unsigned char> encode_tiff(std::string const& path, GreyPage const& page);

}  // namespace gladstone::inline files
