#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "render/base/fields/field_units.h"

namespace gladstone {

/// What a NRRD header says of a scalar field of two or three dimensions.
/// Format: Kindlmann, "Definition of NRRD file format", teem.sourceforge.net/nrrd/format.html.
struct NrrdHeader {
  enum class Encoding { raw, gzip };
  enum class Type { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

  Type type = Type::float32;
  Encoding encoding = Encoding::raw;
  bool big_endian = false;
  std::array<int, 3> sizes{1, 1, 1};             ///< x (fastest), y, z
  std::array<double, 3> spacing{1.0, 1.0, 1.0};  ///< file units
  std::array<double, 3> origin{0.0, 0.0, 0.0};   ///< file units
  FieldUnits units;
  std::string content;          ///< the field's name; may be empty
  std::string data_path;        ///< the header's own file where the data are attached
  std::size_t data_offset = 0;  ///< of the data section in data_path [bytes]
  long line_skip = 0;           ///< lines before the data, as stored
  long long byte_skip = 0;      ///< bytes before the data, as decompressed; -1: data end the file

  std::size_t value_bytes() const;
  int significant_bits() const;  ///< of a value: 24 for float, 53 for double, an integer's width
  std::size_t plane_bytes() const;
  std::size_t data_bytes() const { return plane_bytes() * static_cast<std::size_t>(sizes[2]); }
};

/// Reads the header of a .nrrd or .nhdr file.
/// @throws DataError for anything that is not a scalar field on a grid along the axes in raw or gzip encoding
NrrdHeader read_nrrd_header(std::string const& path);

}  // namespace gladstone
