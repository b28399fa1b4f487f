#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace gladstone {

/// Numeric type in VTK files.
struct VtkNumber {
  std::string_view xml;     ///< name in XML files
  std::string_view legacy;  ///< name in legacy files
  std::size_t bytes;
  int significant_bits;
  double (*read)(char const* bytes, bool swap);
};

/// Reads a number from memory.
/// @param swap  true if its byte order is not that of the machine
template <class Stored>
double read_number(char const* bytes, bool swap) {
  std::array<char, sizeof(Stored)> value;
  std::copy_n(bytes, sizeof(Stored), value.data());
  if (swap) std::reverse(value.begin(), value.end());
  return static_cast<double>(std::bit_cast<Stored>(value));
}

template <class Stored>
constexpr VtkNumber vtk_number(std::string_view xml, std::string_view legacy) {
  return {xml, legacy, sizeof(Stored), std::numeric_limits<Stored>::digits, read_number<Stored>};
}

inline constexpr std::array vtk_numbers{
    vtk_number<float>("Float32", "float"),
    vtk_number<double>("Float64", "double"),
    vtk_number<std::int8_t>("Int8", "char"),
    vtk_number<std::int8_t>("Int8", "signed_char"),
    vtk_number<std::uint8_t>("UInt8", "unsigned_char"),
    vtk_number<std::int16_t>("Int16", "short"),
    vtk_number<std::uint16_t>("UInt16", "unsigned_short"),
    vtk_number<std::int32_t>("Int32", "int"),
    vtk_number<std::uint32_t>("UInt32", "unsigned_int"),
    vtk_number<std::int64_t>("Int64", "long"),
    vtk_number<std::uint64_t>("UInt64", "unsigned_long"),
    vtk_number<std::int64_t>("Int64", "vtktypeint64"),
    vtk_number<std::uint64_t>("UInt64", "vtktypeuint64"),
    // legacy files store 4 bytes per index, whatever its size in memory
    vtk_number<std::int32_t>("Int32", "vtkIdType"),
};

}  // namespace gladstone
