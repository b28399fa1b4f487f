#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "render/base/input_file.h"
#include "render/base/vec.h"

namespace gladstone {

/// How the numbers of a data array stand in a .vti file.
enum class VtiFormat {
  ascii,   ///< as text
  base64,  ///< bytes as base64, in place or appended
  raw,     ///< bytes, appended
};

/// What a .vti file says of the grid and of one of its data arrays.
struct VtiHeader {
  std::array<int, 3> nodes{1, 1, 1};
  Vec3d spacing{1, 1, 1}, origin{};  ///< of node (0, 0, 0); in the file's own unit of length
  std::string name;                  ///< of the data array
  std::string type;                  ///< "Float32", "Int16" ...
  VtiFormat format = VtiFormat::ascii;
  bool compressed = false;     ///< by zlib, in blocks
  bool big_endian = false;     ///< of numbers in bytes
  std::size_t size_bytes = 4;  ///< of the whole numbers that tell how long data are: 4 or 8
  std::uint64_t begin = 0;     ///< of the data in the file
  std::uint64_t end = 0;       ///< of a text of numbers
};

/// Reads the header of a VTK image (XML, ImageData) and finds a data array among its PointData.
/// @param dataset name of the array; empty: the only one of so many components
/// @throws DataError for what is not read here: several pieces, turned axes, other compressors, data of cells
VtiHeader read_vti_header(InputFile const& file, std::string const& dataset, int components);

}  // namespace gladstone
