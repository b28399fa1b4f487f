#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/files/hdf5_handle.h"

/// Parts of Hdf5Reader: opening datasets, and the reasons why they cannot be read. Include only in hdf5_reader.cpp and
/// hdf5_reader_handle.cpp.
namespace gladstone::inline files::hdf5 {

/// Formats a shape: "2000 x 1000 x 1000".
std::string sizes_text(std::vector<std::size_t> const& shape);

/// Describes the values of a type that are not real numbers.
std::string type_name(std::int64_t type);

/// Returns the names of all datasets of a file.
std::vector<std::string> all_datasets(std::int64_t file);

/// Returns the number of values along each axis.
std::vector<std::size_t> shape_of(std::int64_t dataset);

/// Throws DataError with the reason why a dataset cannot be read: filters that are not installed, else damage.
[[noreturn]] void throw_unreadable(std::int64_t dataset, std::string const& path, std::string const& name);

}  // namespace gladstone::inline files::hdf5

namespace gladstone::inline files {

struct Hdf5Reader::Handle {
  hdf5::Id file;
  std::uint64_t bytes = 0;  ///< size of the file [bytes]
  std::string rows_name;    ///< dataset of the last read_rows(), kept open for its chunk cache
  hdf5::Id rows{-1, nullptr};

  /// Opens a numeric dataset. @throws DataError
  hdf5::Id open(std::string const& path, std::string const& dataset, bool integers_only = false) const;
  /// Opens a dataset for reading by rows. Its cache holds all chunks that intersect a row, up to 128 MiB, so that each
  /// chunk is decompressed once whatever the number of rows per call.
  std::int64_t open_rows(std::string const& path, std::string const& dataset);
  /// Reads a box of the dataset opened by open_rows(); `out` has exactly its size. @throws DataError
  void read(std::string const& path, std::string const& dataset, std::vector<unsigned long long> const& start,
            std::vector<unsigned long long> const& size, std::span<double> out) const;
};

}  // namespace gladstone::inline files
