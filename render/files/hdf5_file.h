#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/files/source_files.h"

namespace gladstone::inline files {

/// Provenance of an HDF5 file of gladstone, stored as root attributes.
struct FileOrigin {
  std::string filetype;  ///< "gladstone truth", "gladstone vectors", ...
  int version = 1;
  std::string setup;  ///< full text of the resolved setup
  std::uint64_t seed = 0;
  std::string device = "cpu";
  /// Input files of the result: root attributes NAME_sha256. They are checked again before the file gets its final
  /// name.
  SourceFiles sources = {};
};

/// Reads an HDF5 file. Only Hdf5Reader and Hdf5Writer call the HDF5 C library. They throw DataError (reading) and
/// OutputError (writing), with the file and the dataset in the message; HDF5's own messages are silenced.
class Hdf5Reader {
 public:
  explicit Hdf5Reader(std::string const& path);
  ~Hdf5Reader();
  Hdf5Reader(Hdf5Reader&&) noexcept;

  bool has(std::string const& dataset) const;
  /// Returns the names of the datasets in the root group, for messages.
  std::vector<std::string> dataset_names() const;
  /// Returns the paths of all numeric datasets in all groups, in alphabetical order: "/dots/flux".
  std::vector<std::string> number_datasets() const;
  /// Returns the paths of all reachable numeric datasets, each once, "data/fields/rho": first those in the groups, then
  /// those reached by soft and external links.
  std::vector<std::string> linked_number_datasets() const;
  /// Returns the datasets that hold no real numbers, with what they hold: "\"rho\" of complex numbers".
  std::vector<std::string> describe_other_datasets() const;
  std::vector<std::size_t> shape(std::string const& dataset) const;
  /// Returns the number of significant bits of the stored numbers: 24 for float, 53 for double, the width of an
  /// integer.
  int significant_bits(std::string const& dataset) const;
  /// Reads a whole dataset and converts it to double or to integers.
  /// @throws DataError if the dataset is not numeric (string, compound), or not of integers for read_integers()
  std::vector<double> read(std::string const& dataset) const;
  std::vector<std::int64_t> read_integers(std::string const& dataset) const;
  /// Reads rows [first, first + count) of the leading axis and converts them to double; `out` has exactly their size.
  void read_rows(std::string const& dataset, std::size_t first, std::size_t count, std::span<double> out) const;
  /// Reads a box of a dataset and converts it to double; `out` has exactly its size, the last axis varies fastest.
  void read_box(std::string const& dataset, std::vector<std::size_t> const& start, std::vector<std::size_t> const& size,
                std::span<double> out) const;
  /// Returns, for each axis of a dataset, the path of its netCDF-4 coordinate dataset (dimension scale), or "" if there
  /// is none. HDF5 Dimension Scale Specification, attribute DIMENSION_LIST.
  std::vector<std::string> dimension_scales(std::string const& dataset) const;
  /// Returns the label of each axis of a dataset, "" for axes without one. HDF5 Dimension Scale Specification,
  /// attribute DIMENSION_LABELS.
  std::vector<std::string> dimension_labels(std::string const& dataset) const;
  /// Returns a text or numeric root attribute as text; empty if it does not exist.
  std::string attribute(std::string const& name) const;
  /// Returns a text or numeric attribute of a numeric dataset as text; empty if it does not exist.
  std::string attribute_of(std::string const& dataset, std::string const& name) const;
  /// Returns a numeric attribute of a numeric dataset, one number or several; empty if it does not exist or is not
  /// numeric.
  std::vector<double> number_attribute(std::string const& dataset, std::string const& name) const;

 private:
  std::string path_;
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

/// Dataset and the dimension scale of each of its axes, as absolute paths.
struct ScaledDataset {
  std::string dataset;
  std::vector<std::string> scales;
};

/// Location of the contents of an HDF5 file until the file is closed.
enum class Hdf5Growth {
  in_memory,  ///< in memory; close() writes them to disk
  on_disk,    ///< on disk, row by row, for files larger than memory
};

/// Writes an HDF5 file of gladstone. The file appears under its final name when close() returns.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(std::string const& path, FileOrigin const& origin, Hdf5Growth growth = Hdf5Growth::in_memory);
  ~Hdf5Writer();

  /// Writes a dataset with its attributes `units`, `description` and `axes`.
  /// @param dataset  absolute path; missing groups are created
  /// @param shape    size of each axis; the product equals data.size()
  /// @param axes     meaning of the axes, e.g. "dot, component (u, v)"
  void write(std::string const& dataset, std::span<double const> data, std::vector<std::size_t> const& shape,
             std::string const& units, std::string const& description, std::string const& axes);
  void write(std::string const& dataset, std::span<std::int64_t const> data, std::vector<std::size_t> const& shape,
             std::string const& units, std::string const& description, std::string const& axes);
  /// Creates a dataset of deflated chunks for write_rows(). Rows that are never written read as 0.
  /// @param chunk  chunk size along each axis, at most the size of the axis
  template <class Value>
  void make_rows(std::string const& dataset, std::vector<std::size_t> const& shape,
                 std::vector<std::size_t> const& chunk, std::string const& units, std::string const& description,
                 std::string const& axes);
  /// Writes rows [first, first + n) of the leading axis; `data` has exactly their size. Value is the type of
  /// make_rows(): std::uint16_t or double.
  /// @throws OutputError if the disk is full; the partial file is removed
  template <class Value>
  void write_rows(std::string const& dataset, std::size_t first, std::span<Value const> data);
  /// Writes an attribute of a group or dataset.
  void attribute(std::string const& object, std::string const& name, std::string const& value);
  void attribute(std::string const& object, std::string const& name, double value);
  void attribute(std::string const& object, std::string const& name, std::int64_t value);
  /// Makes datasets the dimension scales of the axes of others (HDF5 Dimension Scale Specification), so that netCDF-4
  /// and xarray name the axes and their coordinates. To be called once per file, with all datasets that have scales.
  void attach_scales(std::vector<ScaledDataset> const& datasets);
  /// Flushes the file to disk, checks for write errors and that no source has changed, and renames it to its final
  /// name.
  void close();

 private:
  std::string path_;
  struct Handle;
  std::unique_ptr<Handle> handle_;
};

}  // namespace gladstone::inline files
