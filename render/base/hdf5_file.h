#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/base/source_files.h"

namespace gladstone {

/// What every HDF5 file of ours says about itself, as root attributes.
struct FileOrigin {
  std::string filetype;  ///< "gladstone truth", "gladstone vectors", ...
  int version = 1;
  std::string setup;  ///< full text of the resolved setup
  std::uint64_t seed = 0;
  std::string device = "cpu";
  /// What the file is made from: root attributes NAME_sha256, and looked at again before it is put in its place.
  SourceFiles sources = {};
};

/// The one place where the HDF5 C library is called. Errors are DataError (reading) and OutputError (writing), with
/// the file and the dataset named; HDF5's own messages are silenced.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(std::string const& path);
  ~Hdf5Reader();
  Hdf5Reader(Hdf5Reader&&) noexcept;

  bool has(std::string const& dataset) const;
  /// Names of the datasets in the root group, for messages.
  std::vector<std::string> dataset_names() const;
  /// Paths of all datasets of numbers, in every group, in alphabetical order: "/dots/flux".
  std::vector<std::string> number_datasets() const;
  /// Paths of all datasets of numbers that can be reached, each once: in every group, then through soft and external
  /// links, "data/fields/rho".
  std::vector<std::string> linked_number_datasets() const;
  std::vector<std::size_t> shape(std::string const& dataset) const;
  /// Bits of precision of the stored numbers: 24 for float, 53 for double, an integer's width.
  int significant_bits(std::string const& dataset) const;
  /// A whole dataset converted to double / integers; a dataset of another type class (string, compound) is an error.
  std::vector<double> read(std::string const& dataset) const;
  std::vector<std::int64_t> read_integers(std::string const& dataset) const;
  /// Rows [first, first + count) of the leading axis, converted to double; `out` has exactly their size.
  void read_rows(std::string const& dataset, std::size_t first, std::size_t count, std::span<double> out) const;
  /// A box of a dataset, converted to double; `out` has exactly its size, the last axis fastest.
  void read_box(std::string const& dataset, std::vector<std::size_t> const& start, std::vector<std::size_t> const& size,
                std::span<double> out) const;
  /// Datasets of the coordinates that netCDF-4 attaches to the axes of a dataset (dimension scales), "" where there is
  /// none. HDF5 Dimension Scale Specification, attribute DIMENSION_LIST.
  std::vector<std::string> dimension_scales(std::string const& dataset) const;
  /// A text or numeric attribute of the root as text; empty where there is none.
  std::string attribute(std::string const& name) const;
  /// The same of a dataset of numbers.
  std::string attribute_of(std::string const& dataset, std::string const& name) const;

 private:
  std::string path_;
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

/// Where a file grows until it is closed.
enum class Hdf5Growth {
  in_memory,  ///< and goes to disk at once
  on_disk,    ///< for files larger than memory, by rows
};

/// Writes one file; nothing is on disk under its final name before close() returns.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(std::string const& path, FileOrigin const& origin, Hdf5Growth growth = Hdf5Growth::in_memory);
  ~Hdf5Writer();

  /// @param dataset absolute name; groups on the way are made
  /// @param shape   product equals data.size()
  /// @param axes    e.g. "dot, component (u, v)"
  void write(std::string const& dataset, std::span<double const> data, std::vector<std::size_t> const& shape,
             std::string const& units, std::string const& description, std::string const& axes);
  void write(std::string const& dataset, std::span<std::int64_t const> data, std::vector<std::size_t> const& shape,
             std::string const& units, std::string const& description, std::string const& axes);
  /// A dataset to be filled by write_rows(): deflated chunks; what is never written reads as 0.
  /// @param chunk of every axis, at most its size
  template <class Value>
  void make_rows(std::string const& dataset, std::vector<std::size_t> const& shape,
                 std::vector<std::size_t> const& chunk, std::string const& units, std::string const& description,
                 std::string const& axes);
  /// Writes rows [first, first + n) of the leading axis; `data` has exactly their size. Value is that of make_rows():
  /// std::uint16_t or double.
  /// @throws OutputError where the disk has no room for them; nothing is left of the file
  template <class Value>
  void write_rows(std::string const& dataset, std::size_t first, std::span<Value const> data);
  void attribute(std::string const& object, std::string const& name, std::string const& value);
  void attribute(std::string const& object, std::string const& name, double value);
  void attribute(std::string const& object, std::string const& name, std::int64_t value);
  /// Flushes, checks that everything arrived on disk, renames to the final name.
  void close();

 private:
  std::string path_;
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace gladstone
