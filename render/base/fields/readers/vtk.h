#pragma once

#include <memory>

#include "render/base/fields/readers/checked_source.h"

namespace gladstone {

/// Opens a VTK image (.vti, ImageData) or rectilinear grid (.vtr) in XML, of one or several pieces, with its data in
/// place or appended, as text, base64 or raw bytes, as they are or compressed by zlib, LZ4 or LZMA; numbers of any type
/// and either byte order. Data of points, or of cells, whose values belong to the cells' centres. Axes of an image may
/// be exchanged or run backwards (Direction). Lengths have no unit there. The array is held in memory.
/// @throws DataError for what is not read here, and for data that are cut short or damaged
std::unique_ptr<CheckedSource> open_vtk_xml(std::string const& path, FieldWish const& wish);

/// Opens a legacy VTK file (.vtk): STRUCTURED_POINTS or RECTILINEAR_GRID, ASCII or BINARY, data of points or cells.
/// @throws DataError as open_vtk_xml
std::unique_ptr<CheckedSource> open_vtk_legacy(std::string const& path, FieldWish const& wish);

}  // namespace gladstone
