#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/base/input_file.h"

namespace gladstone {

/// How a VTK XML file encodes the bytes of its arrays.
struct VtkEncoding {
  enum class Compressor { none, zlib, lz4, lzma };
  Compressor compressor = Compressor::none;
  bool big_endian = false;
  std::size_t length_bytes = 4;  ///< of the integers that say how long data are: 4 (UInt32) or 8 (UInt64)
};

/// Where the values of an array are.
struct VtkPayload {
  enum class Format { ascii, base64, raw };
  Format format = Format::ascii;
  bool appended = false;     ///< behind <AppendedData>, not in place
  std::uint64_t offset = 0;  ///< of appended data in the file
  std::string text;          ///< of data in place
};

/// The bytes of an array, decoded and decompressed. Base64 may consist of several pieces with padding of their own (the
/// header of lengths, then the data), and of several lines.
/// @param size bytes that the grid needs
/// @throws DataError where they are cut short, damaged or of another length
std::vector<char> decode_bytes(VtkPayload const& payload, VtkEncoding const& encoding, InputFile const& file,
                               std::string const& name, std::uint64_t size);

/// The numbers of an array in text. @throws DataError where there are more or fewer, or something else
std::vector<double> decode_text(VtkPayload const& payload, InputFile const& file, std::string const& name,
                                std::uint64_t count);

}  // namespace gladstone
