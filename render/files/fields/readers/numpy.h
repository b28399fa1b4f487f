#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// Opens an array of NumPy, format 1.0 to 3.0, of floats, integers or booleans in either byte order, in C or Fortran
/// order; its shape is [nz, ny, nx] in either. It has no coordinates, so that its spacing is 1. Arrays in C order are
/// read from the file as needed, others are held in memory. Format: NumPy, "numpy.lib.format".
/// @throws DataError as open_array_field(), and for objects, records, text, complex numbers and truncated data
std::unique_ptr<CheckedSource> open_npy(std::string const& path, FieldSelection const& selection);

/// Opens an array of numpy.savez() or numpy.savez_compressed(); arrays x, y, z are its coordinates, as
/// open_array_field() describes. Compressed arrays are held in memory.
/// @throws DataError as open_npy(), and for damaged archives
std::unique_ptr<CheckedSource> open_npz(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone::inline files
