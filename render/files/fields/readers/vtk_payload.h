#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "render/files/input_file.h"

namespace gladstone::inline files {

/// Encoding of the arrays of a VTK XML file.
struct VtkEncoding {
  enum class Compressor { none, zlib, lz4, lzma };
  Compressor compressor = Compressor::none;
  bool big_endian = false;
  std::size_t length_bytes = 4;  ///< size of the integers in the length headers [bytes]: 4 (UInt32) or 8 (UInt64)
};

/// Location and format of the values of an array.
struct VtkPayload {
  enum class Format { ascii, base64, raw };
  Format format = Format::ascii;
  bool appended = false;     ///< the array is in the section <AppendedData>, not inline
  std::uint64_t offset = 0;  ///< offset of appended data in the file [bytes]
  std::string text;          ///< text of inline data
};

/// Decodes and decompresses the bytes of an array. Base64 data may consist of several separately padded blocks (the
/// length header, then the data) and of several lines.
/// @param size  number of bytes that the grid requires
/// @throws DataError if the data are truncated, damaged or of another length
std::vector<char> decode_bytes(VtkPayload const& payload, VtkEncoding const& encoding, InputFile const& file,
                               std::string const& name, std::uint64_t size);

/// Parses the numbers of an array in text format.
/// @param count  number of values that the grid requires
/// @throws DataError if there are more or fewer, or if the text contains anything else
std::vector<double> decode_text(VtkPayload const& payload, InputFile const& file, std::string const& name,
                                std::uint64_t count);

}  // namespace gladstone::inline files
