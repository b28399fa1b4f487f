#pragma once

#include <string>

namespace gladstone {

/// What a file holds, as its content shows: the filetype of a gladstone HDF5 file ("gladstone truth"), "HDF5", "TIFF",
/// "PNG", "PDF", "HTML", "SVG", "JSON", "TOML", or "gladstone vectors" of a CSV file. Empty for anything else, for an
/// empty file and where there is none.
/// @param name of the file, where `path` is a temporary one (its ending says what text is)
std::string file_kind(std::string const& path, std::string const& name);
inline std::string file_kind(std::string const& path) { return file_kind(path, path); }

}  // namespace gladstone
