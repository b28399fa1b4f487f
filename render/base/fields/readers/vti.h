#pragma once

#include <memory>
#include <string>

#include "render/base/fields/field_file.h"

namespace gladstone {

/// Opens a VTK image (.vti: XML, ImageData, one piece), with its data in place or appended, as text, base64 or raw
/// bytes, as they are or compressed by zlib; numbers of any type and either byte order. Data of points are read, not
/// those of cells. Lengths have no unit there. The data array is held in memory as it is stored.
/// @param dataset name of a data array; empty: the only one of so many components
/// @param values components: 1 of a scalar field, 3 of a velocity
/// @throws DataError for what is not read here, and for data that are cut short or damaged
std::unique_ptr<FieldSource> open_vti(std::string const& path, std::string const& dataset, int values);

}  // namespace gladstone
