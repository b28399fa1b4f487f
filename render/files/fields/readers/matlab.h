#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/files/fields/readers/checked_source.h"
#include "render/files/fields/readers/listed_arrays.h"

namespace gladstone::inline files {

/// Opens an array in a MAT-file of MATLAB: level 5 (versions 5 to 7, also compressed; MathWorks, "MAT-File Format") or
/// version 7.3 (HDF5). MATLAB's first index varies fastest, so that the shape [nx, ny, nz] of ndgrid is read as [nz,
/// ny, nx], and [ny, nx, nz] of meshgrid as [nz, nx, ny]. Arrays x, y, z are coordinates, see open_array_field().
/// Compressed arrays are held in memory.
/// @throws DataError as open_array_field(), and for truncated or damaged files
std::unique_ptr<CheckedSource> open_matlab(std::string const& path, FieldSelection const& selection);

/// Returns the arrays of numbers in a MAT-file of level 5 or version 7.3, with their shapes as open_matlab() reads
/// them.
/// @param wanted  kind of file expected, for messages: "a file of vectors"
/// @throws DataError for other files, and for truncated or damaged ones
std::vector<ListedArray> list_matlab_arrays(std::string const& path, std::string const& wanted);

}  // namespace gladstone::inline files
