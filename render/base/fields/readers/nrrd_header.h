#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "render/base/fields/field_axes.h"
#include "render/base/fields/field_units.h"

namespace gladstone {

/// What a NRRD header says of a field of two or three dimensions.
/// Format: Kindlmann, "Definition of NRRD file format", teem.sourceforge.net/nrrd/format.html.
struct NrrdHeader {
  enum class Encoding { raw, gzip, bzip2, ascii, hex };
  enum class Type { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

  Type type = Type::float32;
  Encoding encoding = Encoding::raw;
  bool big_endian = false;
  int values = 1;                     ///< numbers at every node, side by side
  std::size_t dimension = 3;          ///< axes in space: 2 or 3
  std::array<int, 3> sizes{1, 1, 1};  ///< of the axes in space, the fastest first
  StoredAxes axes = default_axes();
  bool directed = false;  ///< the header says which axis is which ("space directions")
  FieldUnits units;
  std::vector<std::string> notes;  ///< what had to be assumed
  std::string content;             ///< the field's name; may be empty
  std::string data_path;           ///< the header's own file where the data are attached
  std::size_t data_offset = 0;     ///< of the data section in data_path [bytes]
  long line_skip = 0;              ///< lines before the data, as stored
  long long byte_skip = 0;         ///< bytes before the data, as decompressed; -1: data end the file

  std::size_t value_bytes() const;
  int significant_bits() const;  ///< of a value: 24 for float, 53 for double, an integer's width
  std::size_t plane_bytes() const;
  std::size_t data_bytes() const { return plane_bytes() * static_cast<std::size_t>(sizes[2]); }
  std::string sizes_text() const;  ///< "24 x 20 x 16"
};

/// Reads the header of a .nrrd or .nhdr file.
/// @param values numbers at every node
/// @throws DataError for anything that is not such a field on a grid along the axes
NrrdHeader read_nrrd_header(std::string const& path, int values);

}  // namespace gladstone
