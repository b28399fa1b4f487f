#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/files/fields/readers/byte_range.h"
#include "render/files/fields/readers/stored_number.h"

namespace gladstone::inline files {

/// Numeric type of an array: kind and number of bytes, as in its header.
struct NumpyType : StoredNumber {
  std::string_view code;
};

/// Header of an array.
struct NpyHeader {
  std::string dtype;  ///< NumPy type of an element, "<f4"; that of a record begins with "["
  bool fortran = false;
  std::vector<std::size_t> shape;
  std::uint64_t data = 0;           ///< offset of the first value
  std::optional<NumpyType> type{};  ///< numeric type; nullopt: the array holds no real numbers
  bool swap = false;
};

/// Reads the header of an array. @throws DataError if it is none, or damaged
NpyHeader read_npy_header(ByteRange const& range);

}  // namespace gladstone::inline files
