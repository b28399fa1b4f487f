#pragma once

#include <string>

namespace gladstone {

/// Determines the kind of a file from its content: the filetype of a gladstone HDF5 file ("gladstone truth"), "HDF5",
/// "damaged HDF5", "TIFF", "PNG", "PDF", "HTML", "SVG", "VTK", other "XML", "NRRD", "JSON", "TOML", or "gladstone
/// vectors" for a CSV file of vectors. Empty for other content, empty files, and if the file does not exist.
/// @param name  final name of the file if `path` is a temporary one; TOML is recognised only if it ends in ".toml"
std::string file_kind(std::string const& path, std::string const& name);
inline std::string file_kind(std::string const& path) { return file_kind(path, path); }

}  // namespace gladstone
