#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/field_axes.h"
#include "render/files/fields/field_units.h"

namespace gladstone::inline files {

/// Header of a NRRD file that contains a field of two or three dimensions. Format: Kindlmann, "Definition of NRRD file
/// format", teem.sourceforge.net/nrrd/format.html.
struct NrrdHeader {
  enum class Encoding { raw, gzip, bzip2, ascii, hex };
  enum class Type { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

  Type type = Type::float32;
  Encoding encoding = Encoding::raw;
  bool big_endian = false;
  int values = 1;                     ///< number of values per node, stored contiguously
  std::size_t dimension = 3;          ///< number of spatial axes, 2 or 3
  std::array<int, 3> sizes{1, 1, 1};  ///< nodes along the spatial axes, fastest first
  StoredAxes axes = default_axes();
  bool directed = false;  ///< the header assigns world axes by "space directions"
  bool labelled = false;  ///< the header assigns world axes by "labels"
  FieldUnits units;
  Warnings notes;               ///< assumptions made, for warnings
  std::string content;          ///< name of the field (entry "content"); may be empty
  std::string data_path;        ///< file of the data; the header's file if they are attached
  std::size_t data_offset = 0;  ///< offset of the data section in data_path [bytes]
  long line_skip = 0;           ///< lines to skip before the data, before decompression
  long long byte_skip = 0;      ///< bytes to skip before the data, after decompression; -1: the data end the file

  std::size_t value_bytes() const;
  int significant_bits() const;  ///< significant bits of a value: 24 for float, 53 for double, the width of an integer
  std::size_t plane_bytes() const;
  std::size_t data_bytes() const { return plane_bytes() * static_cast<std::size_t>(sizes[2]); }
  std::string sizes_text() const;  ///< "24 x 20 x 16"
};

/// Reads the header of a .nrrd or .nhdr file.
/// @param values  number of values per node
/// @throws DataError if it is not a field on a grid along the world axes
NrrdHeader read_nrrd_header(std::string const& path, int values);

}  // namespace gladstone::inline files
