#pragma once

#include <cstddef>
#include <vector>

/// Compression of datasets as by HDF5's filters "shuffle" and "deflate". It does not call the HDF5 library, which
/// serves one thread at a time.
namespace gladstone::inline files {

/// Compression level of deflate. Only the leading bytes of measured numbers are compressible, so that higher levels
/// take 1.3 times as long for files that are 1 % smaller.
inline constexpr int deflate_level = 1;
inline constexpr std::size_t max_chunk_bytes = 1024 * 1024;

/// Returns the shape of a dataset's chunks: that of the dataset, halved along its leading axes to at most
/// max_chunk_bytes.
/// @pre the dataset is not empty
std::vector<std::size_t> chunk_shape(std::vector<std::size_t> const& shape, std::size_t value_bytes);

/// Compressed chunk.
struct DeflatedChunk {
  std::vector<std::size_t> start;  ///< indices of the first value of the chunk in the dataset
  std::vector<unsigned char> bytes;
};

/// Compresses the datasets of a file.
class ChunkDeflater {
 public:
  /// @param retains  true: datasets of one chunk with equal values, such as a column and its copy on a grid, are
  /// compressed once; for this comparison, earlier datasets are held in memory
  explicit ChunkDeflater(bool retains = true) : retains_(retains) {}

  /// Compresses a dataset chunk by chunk. Chunks that exceed the dataset are filled with zeros.
  /// @param data   values in the order of memory, the last axis varies fastest
  /// @param chunk  chunk_shape()
  std::vector<DeflatedChunk> deflate(void const* data, std::vector<std::size_t> const& shape,
                                     std::vector<std::size_t> const& chunk, std::size_t value_bytes);

 private:
  struct Known {
    std::vector<unsigned char> values, deflated;
  };
  bool retains_;
  std::vector<Known> known_;  ///< compressed datasets of a single chunk; equal datasets are not compressed again
};

}  // namespace gladstone::inline files
