#include "render/files/hdf5_chunks.h"

#include <zlib.h>

#include <algorithm>
#include <functional>
#include <new>
#include <numeric>
#include <span>

namespace gladstone {
namespace {

/// Compresses `count` values; the chunk is filled with zeros beyond them.
std::vector<unsigned char> deflate_values(unsigned char const* values, std::size_t count, std::size_t value_bytes,
                                          std::size_t chunk_values) {
  std::vector<unsigned char> shuffled(chunk_values * value_bytes);
  for (std::size_t byte = 0; byte < value_bytes; ++byte)
    for (std::size_t i = 0; i < count; ++i) shuffled[byte * chunk_values + i] = values[i * value_bytes + byte];
  uLongf size = compressBound(shuffled.size());
  std::vector<unsigned char> deflated(size);
  if (compress2(deflated.data(), &size, shuffled.data(), shuffled.size(), deflate_level) != Z_OK)
    throw std::bad_alloc();  // the buffer is large enough, so that only memory can be short
  deflated.resize(size);
  return deflated;
}

constexpr std::size_t most_known = 32;  // datasets that are retained for comparison, at most 1 MiB each

std::size_t count_values(std::vector<std::size_t> const& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::vector<DeflatedChunk> deflate_all(unsigned char const* bytes, std::vector<std::size_t> const& shape,
                                       std::vector<std::size_t> const& chunk, std::size_t value_bytes) {
  std::vector<DeflatedChunk> chunks;
  std::size_t const chunk_values = count_values(chunk);
  std::vector<std::size_t> start(shape.size(), 0);
  while (start[0] < shape[0]) {
    // Every chunk is contiguous: it has one value along the axes before the one that is divided, and is whole along
    // those after it.
    std::size_t first = 0, count = 1;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) {
      first = first * shape[axis] + start[axis];
      count *= std::min(chunk[axis], shape[axis] - start[axis]);
    }
    chunks.push_back({start, deflate_values(bytes + first * value_bytes, count, value_bytes, chunk_values)});
    for (std::size_t axis = shape.size(); axis-- > 0;) {
      start[axis] += chunk[axis];
      if (start[axis] < shape[axis] || axis == 0) break;
      start[axis] = 0;
    }
  }
  return chunks;
}

}  // namespace

std::vector<std::size_t> chunk_shape(std::vector<std::size_t> const& shape, std::size_t value_bytes) {
  std::vector<std::size_t> chunk = shape;
  for (std::size_t axis = 0; axis < chunk.size() && count_values(chunk) * value_bytes > max_chunk_bytes;) {
    if (chunk[axis] == 1) {
      ++axis;
    } else {
      chunk[axis] = (chunk[axis] + 1) / 2;
    }
  }
  return chunk;
}

std::vector<DeflatedChunk> ChunkDeflater::deflate(void const* data, std::vector<std::size_t> const& shape,
                                                  std::vector<std::size_t> const& chunk, std::size_t value_bytes) {
  auto const* const bytes = static_cast<unsigned char const*>(data);
  if (chunk != shape) return deflate_all(bytes, shape, chunk, value_bytes);
  std::span<unsigned char const> const values(bytes, count_values(shape) * value_bytes);
  std::vector<std::size_t> const start(shape.size(), 0);
  for (Known const& known : known_)
    if (std::equal(values.begin(), values.end(), known.values.begin(), known.values.end()))
      return {{start, known.deflated}};
  std::vector<DeflatedChunk> chunks = deflate_all(bytes, shape, chunk, value_bytes);
  if (retains_ && known_.size() < most_known)
    known_.push_back({std::vector<unsigned char>(values.begin(), values.end()), chunks.front().bytes});
  return chunks;
}

}  // namespace gladstone
