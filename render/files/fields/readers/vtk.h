#pragma once

#include <memory>

#include "render/files/fields/readers/checked_source.h"

namespace gladstone::inline files {

/// Opens a VTK image (.vti, ImageData) or rectilinear grid (.vtr) in XML, of one or several pieces, as text, base64 or
/// raw bytes, inline or appended, uncompressed or compressed by zlib, LZ4 or LZMA, of any numeric type and byte order.
/// Point data, or cell data, which are assigned to the cell centres. The axes of an image may be permuted or reversed
/// (Direction). The format has no unit of length. The array is held in memory.
/// @throws DataError for unsupported features and for truncated or damaged data
std::unique_ptr<CheckedSource> open_vtk_xml(std::string const& path, FieldSelection const& selection);

/// Opens a legacy VTK file (.vtk): STRUCTURED_POINTS or RECTILINEAR_GRID, ASCII or BINARY, point or cell data.
/// @throws DataError as open_vtk_xml()
std::unique_ptr<CheckedSource> open_vtk_legacy(std::string const& path, FieldSelection const& selection);

}  // namespace gladstone::inline files
