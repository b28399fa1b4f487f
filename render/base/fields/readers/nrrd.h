#pragma once

#include <memory>
#include <string>

#include "render/base/fields/field_file.h"

namespace gladstone {

/// Opens a NRRD field, attached (.nrrd) or detached (.nhdr with "data file"), raw or gzip, of any type of numbers and
/// either byte order, of two or three dimensions; the first axis is x, the y index runs upwards. Spacing and origin
/// come from "spacings" or "space directions" (along the axes) and "space origin", in the unit of "units" or "space
/// units"; without them 1 and 0. Compressed data are streamed: planes read in ascending order are decompressed once.
/// @param dataset must be empty: a NRRD file holds one field
/// @param values must be 1: a velocity is not read here
/// @throws DataError for what is not read here (other encodings, several data files, oblique axes) and for data that
///         are cut short, with the bytes there and the bytes needed
std::unique_ptr<FieldSource> open_nrrd(std::string const& path, std::string const& dataset, int values);

}  // namespace gladstone
