#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "render/files/hdf5_chunks.h"
#include "render/files/hdf5_file.h"
#include "render/files/hdf5_handle.h"

/// Content of an HDF5 file before it is written, for hdf5_writer.cpp. Values are compressed and retained without calls
/// of the HDF5 library, so that several threads prepare files at the same time. Functions with a parameter `file` (an
/// identifier of HDF5, hid_t) require that the library is locked; `path` is the file's name, for messages.
namespace gladstone::inline files::hdf5 {

enum class ValueType { float64, int64, uint16 };
/// Returns the type of values in memory and in the file (hid_t). @pre the library is locked
std::int64_t native_type(ValueType type);

/// Dataset with its attributes.
struct HeldDataset {
  std::string name;  ///< absolute path
  ValueType type = ValueType::float64;
  std::vector<std::size_t> shape;
  std::string units, description, axes;
  std::vector<std::size_t> chunk;     ///< shape of the chunks; empty: not compressed
  std::vector<DeflatedChunk> chunks;  ///< values of a compressed dataset
  std::vector<unsigned char> values;  ///< values of an uncompressed dataset
};

/// Creates a dataset, with its groups and texts, without values.
/// @param level  compression level of deflate, used if the dataset has chunks
void create_dataset(std::int64_t file, std::string const& path, HeldDataset const& dataset, int level);
/// Writes the values of a dataset that exists.
void fill_dataset(std::int64_t file, std::string const& path, HeldDataset const& dataset);

/// Attribute of a group or dataset.
struct HeldAttribute {
  std::string object, name;
  std::variant<std::string, double, std::int64_t> value;
};
/// Writes an attribute, in place of an earlier one of the same name.
void set_attribute(std::int64_t file, std::string const& path, HeldAttribute const& attribute);

/// Writes those attributes of a FileOrigin that all results of a command have in common.
void write_origin(std::int64_t file, std::string const& path, FileOrigin const& origin);

/// Content of a file.
struct HeldContent {
  FileOrigin origin;
  std::vector<HeldDataset> datasets;
  std::vector<ScaledDataset> scales;
  std::vector<HeldAttribute> attributes;
};
/// Returns the bytes of a file; locks the library. The library spends most of its time on creating datasets and
/// attributes, while other threads wait. Since all files of a sequence have the same ones, they are copied without
/// values from the previous file of the same structure.
/// @param content  content of the file; the memory of its datasets is released as they are written
std::vector<char> make_file_image(std::string const& path, HeldContent content);

}  // namespace gladstone::inline files::hdf5
