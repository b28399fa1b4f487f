#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/image.h"

namespace gladstone::inline files {

/// Computes the SHA-256 hash of an image's content: columns, rows, bits per stored sample and the grey levels as
/// returned by read_image(); dates, names and other metadata are excluded. If all grey levels are integers from 0 to
/// 65535, they are hashed as little-endian 16-bit integers, row by row, else as 64-bit floats.
/// @param sample_bits  bits per sample in the file, as ImageMetadata::sample_bits
std::string pixel_sha256(Image<double> const& picture, int sample_bits);
/// Computes the same hash of grey levels that are stored as integers, by default as in a file of write_tiff().
std::string pixel_sha256(Image<std::uint16_t> const& picture, int sample_bits = 16);
/// Computes the hash of an image file. @throws DataError
std::string pixel_sha256(std::string const& path);

/// Computes the SHA-256 hash of an HDF5 file's content: path, shape and values of every numeric dataset, in the order
/// of their paths. Attributes (dates, versions, device) and datasets named "seconds_*" or "device" are excluded.
/// @throws DataError
std::string dataset_sha256(std::string const& path);

/// Returns true for the name of an HDF5 file: .h5 or .hdf5.
bool has_hdf5_ending(std::string const& path);

/// Computes the SHA-256 hash of a file's bytes. @throws DataError
std::string byte_sha256(std::string const& path);

/// Input files of a result with the hashes of their content when they were read. The result stores the hashes, and is
/// only written if the files have not changed since.
class SourceFiles {
 public:
  enum class Holds { pixels, datasets, bytes };

  /// Adds a file that is about to be read, and hashes it unless its hash is known. @throws DataError
  void add(std::string name, std::string path, Holds holds);
  /// Adds a file that is about to be read, and hashes the datasets of an HDF5 file or the bytes of any other.
  /// @throws DataError
  void add(std::string name, std::string path);
  /// Adds a file that was hashed when it was read.
  void add(std::string name, std::string path, Holds holds, std::string sha256);
  /// Reads an image, adds it with the hash of its pixels, and returns it. @throws DataError
  Image<double> add_image(std::string name, std::string path);
  /// Adds an input that check() skips, since it is written together with the result or cannot change.
  void add_known(std::string name, std::string sha256);
  /// Sets the remedy in the message about a changed file: "run gladstone correlate CASE again".
  void on_change(std::string advice) { advice_ = std::move(advice); }

  struct Source {
    std::string name;  ///< "reference", "flow", "vectors", "truth"; empty: checked, but not stored in the result
    std::string path;  ///< path of the file; empty: not checked
    Holds holds = Holds::bytes;
    std::string sha256;
  };
  std::vector<Source> const& all() const { return sources_; }
  /// Returns the hash of the source of this name; empty if there is none.
  std::string sha256(std::string const& name) const;

  /// Hashes every file again.
  /// @throws DataError naming the first file whose content has changed or that cannot be read
  void check() const;

 private:
  std::vector<Source> sources_;
  std::string advice_ = "run the command again";
};

}  // namespace gladstone::inline files
