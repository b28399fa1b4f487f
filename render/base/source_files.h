#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/image.h"

namespace gladstone {

/// SHA-256 of what a picture holds: columns, rows, bits of a stored sample and grey values as read_image() gives them;
/// of no date, name or other text. Whole numbers up to 65535 are hashed as 16-bit numbers, little-endian, row by row;
/// pictures with any other value as 64-bit floats.
/// @param sample_bits of the file, as in ImageMetadata
std::string pixel_sha256(Image<double> const& picture, int sample_bits);
/// Of a picture as write_tiff() writes it.
std::string pixel_sha256(Image<std::uint16_t> const& picture);
/// Of a picture in a file. @throws DataError
std::string pixel_sha256(std::string const& path);

/// SHA-256 of what an HDF5 file holds: path, shape and values of every dataset of numbers, in the order of their paths;
/// of no attribute (dates, versions, device), nor of datasets whose name starts with "seconds_" or is "device".
/// @throws DataError
std::string dataset_sha256(std::string const& path);

/// SHA-256 of a file's bytes. @throws DataError
std::string byte_sha256(std::string const& path);

/// The files that a result is made from, by what they held when they were read. A result carries their hashes and is
/// put in its place only if they hold the same then.
class SourceFiles {
 public:
  enum class Holds { pixels, datasets, bytes };

  /// Hashes a file that is about to be read. @throws DataError
  void add(std::string name, std::string path, Holds holds);
  /// A file that has been read, hashed as it was read.
  void add(std::string name, std::string path, Holds holds, std::string sha256);
  /// A file that is written together with the result, or that cannot change under it.
  void add_known(std::string name, std::string sha256);
  /// What to do where a file has changed: "run gladstone correlate CASE again".
  void on_change(std::string advice) { advice_ = std::move(advice); }

  struct Source {
    std::string name;  ///< "reference", "flow", "vectors", "truth"; empty: looked at again, but not told
    std::string path;  ///< empty: not looked at again
    Holds holds = Holds::bytes;
    std::string sha256;
  };
  std::vector<Source> const& all() const { return sources_; }
  /// The hash of a source; empty where there is none of this name.
  std::string sha256(std::string const& name) const;

  /// Hashes every file again. @throws DataError naming the first that holds something else, or cannot be read any more
  void check() const;

 private:
  std::vector<Source> sources_;
  std::string advice_ = "run the command again";
};

}  // namespace gladstone
