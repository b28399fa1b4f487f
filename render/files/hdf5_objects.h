#pragma once

#include <cstdint>
#include <string>

#include "render/files/hdf5_handle.h"

/// Attributes and groups of an HDF5 file that is being written, for hdf5_writer.cpp. All functions require that the
/// library is locked (library_lock()), and throw OutputError if HDF5 fails.
/// `file` and `object` are identifiers of HDF5 (hid_t); `path` is the file's name, for messages.
namespace gladstone::inline files::hdf5 {

/// Throws OutputError unless `good`.
/// @param what  what cannot be written
void check(bool good, std::string const& path, std::string const& what);

/// Writes an attribute that does not exist yet.
/// @param type  type of the value in memory and in the file (hid_t)
void write_attribute(std::int64_t object, std::string const& path, std::string const& name, std::int64_t type,
                     void const* value);
void write_attribute(std::int64_t object, std::string const& path, std::string const& name, std::string const& value);

/// Opens a group or dataset for an attribute, after removal of an earlier attribute of the same name.
Id open_object(std::int64_t file, std::string const& path, std::string const& object, std::string const& attribute);

/// Creates the groups above a dataset, without modification times, so that equal input gives equal files.
void make_groups(std::int64_t file, std::string const& path, std::string const& dataset);

}  // namespace gladstone::inline files::hdf5
