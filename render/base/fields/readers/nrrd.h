#pragma once

#include <memory>

#include "render/base/fields/readers/checked_source.h"

namespace gladstone {

/// Opens a NRRD field, attached (.nrrd) or detached (.nhdr with "data file"), in any encoding (raw, gzip, bzip2, ascii,
/// hex), of any type of numbers and either byte order, of two or three dimensions; further axes of length one are left
/// out. The first axis is x, the second y, unless "space directions" or the caller name them otherwise. Spacing and
/// origin come from "spacings", "axis mins" and "axis maxs", or "space directions" and "space origin", in the unit of
/// "units" or "space units". The components of a velocity are the first axis. Raw data are read in place, gzip is
/// streamed (planes read in ascending order are decompressed once), other encodings are held in memory.
/// @throws DataError for what is not read here (several data files, oblique axes), and for data that are cut short or
///         longer than the header says, with the bytes there and the bytes needed
std::unique_ptr<CheckedSource> open_nrrd(std::string const& path, FieldWish const& wish);

}  // namespace gladstone
