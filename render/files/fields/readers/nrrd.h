#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// Opens a NRRD field, attached (.nrrd) or detached (.nhdr with "data file"), of two or three dimensions and any
/// additional axes of length one, in any encoding (raw, gzip, bzip2, ascii, hex), numeric type and byte order.
/// - The first axis is x, the second y, unless "space directions", "labels" or the caller name them otherwise; the
///   components of a velocity are the first axis.
/// - Spacing and origin are read from "spacings", "axis mins" and "axis maxs", or "space directions" and "space
///   origin", in the unit of "units" or "space units".
/// - Raw data are read from the file as needed; gzip is streamed (ascending planes are decompressed once); data in
///   other encodings are held in memory.
/// @throws DataError for unsupported features (several data files, oblique axes), and for data shorter or longer than
///         the header declares, with the present and required number of bytes
std::unique_ptr<CheckedSource> open_nrrd(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone::inline files
