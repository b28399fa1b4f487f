#pragma once

#include <cstdint>
#include <string>

#include "render/files/fields/readers/vtk_numbers.h"
#include "render/files/fields/readers/vtk_source.h"
#include "render/files/fields/value_store.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {

/// Array of a legacy file, with the offset of its numbers in the file [bytes].
struct VtkLegacyArray {
  std::string name;
  VtkPlace place = VtkPlace::points;
  VtkNumber number{};
  std::uint64_t components = 1, tuples = 0, begin = 0;

  std::uint64_t values() const { return components * tuples; }
};

/// Reads the numbers of an array.
/// @param text  the file is ASCII, not BINARY
/// @throws DataError if a number is missing or damaged
ValueStore load_legacy_array(InputFile const& file, VtkLegacyArray const& array, bool text);

/// Throws a DataError: the file ends within the array.
[[noreturn]] void refuse_incomplete(InputFile const& file, VtkLegacyArray const& array);

}  // namespace gladstone::inline files
