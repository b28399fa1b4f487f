#pragma once

#include <string>

namespace gladstone::inline files {

/// Result of file_kind() for an HDF5 file that cannot be read.
inline constexpr char const* damaged_hdf5 = "damaged HDF5";

/// Determines the kind of a file from its content: the filetype of a gladstone HDF5 file ("gladstone truth"), "HDF5",
/// "damaged HDF5", "TIFF", "PNG", "PDF", "HTML", "SVG", "VTK", other "XML", "NRRD", "MATLAB" (level 5), "NumPy" (.npy),
/// "JSON", "TOML", "Markdown", or for a CSV file of gladstone "gladstone vectors", "gladstone rays" (trace), "gladstone
/// study table", "gladstone study points", "gladstone benchmark" or "gladstone uncertainty combination". Empty for
/// other content, empty files, and if the file does not exist.
/// @param name  final name of the file if `path` is a temporary one; TOML is recognised only if it ends in ".toml",
///              Markdown if it ends in ".md" and begins with a heading
std::string file_kind(std::string const& path, std::string const& name);
inline std::string file_kind(std::string const& path) { return file_kind(path, path); }

}  // namespace gladstone::inline files
