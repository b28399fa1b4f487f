#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "render/files/fields/readers/stored_number.h"

namespace gladstone::inline files {

/// Numeric type in VTK files.
struct VtkNumber : StoredNumber {
  std::string_view xml;     ///< name in XML files
  std::string_view legacy;  ///< name in legacy files
};

template <class Stored>
constexpr VtkNumber vtk_number(std::string_view xml, std::string_view legacy) {
  return {stored_number<Stored>(), xml, legacy};
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

}  // namespace gladstone::inline files
