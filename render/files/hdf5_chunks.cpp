#include "render/files/hdf5_chunks.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>
#include <span>
#include <utility>

#include "render/files/hdf5_handle.h"

namespace gladstone::inline files {
namespace {

/// Entropy of the distribution of bytes above which they are stored without compression [bits]. Coding symbols by their
/// frequencies would save less than 1.3 % of such bytes, and they contain no long repetitions. Fewer than 2000 bytes
/// never have so large an entropy.
constexpr double incompressible_bits = 7.9;

bool is_incompressible(std::span<unsigned char const> bytes) {
  std::array<std::uint32_t, 256> counts{};
  for (unsigned char const byte : bytes) ++counts[byte];
  double sum = 0;  // sum of count log2(count) over all byte values, for Shannon's entropy
  for (double const count : counts) sum += count > 0 ? count * std::log2(count) : 0;
  auto const total = static_cast<double>(bytes.size());
  return std::log2(total) - sum / total > incompressible_bits;
}

/// Stream of zlib that compresses one chunk.
class Deflation {
 public:
  /// @param size   size of the chunk [bytes]
  /// @param parts  number of calls of add()
  Deflation(std::size_t size, std::size_t parts) : bytes_(compressBound(size) + parts * bytes_per_part) {
    check(deflateInit(&stream_, deflate_level) == Z_OK);
    stream_.next_out = bytes_.data();
    stream_.avail_out = static_cast<uInt>(bytes_.size());
  }
  Deflation(Deflation const&) = delete;
  ~Deflation() { deflateEnd(&stream_); }

  void add(std::span<unsigned char> part, bool last) {
    check(deflateParams(&stream_, is_incompressible(part) ? Z_NO_COMPRESSION : deflate_level, Z_DEFAULT_STRATEGY) ==
          Z_OK);
    stream_.next_in = part.data();
    stream_.avail_in = static_cast<uInt>(part.size());
    check(::deflate(&stream_, last ? Z_FINISH : Z_NO_FLUSH) == (last ? Z_STREAM_END : Z_OK));
  }
  std::vector<unsigned char> finish() && {
    bytes_.resize(stream_.total_out);
    return std::move(bytes_);
  }

 private:
  // additional memory per part, for the headers that zlib writes when the level changes
  static constexpr std::size_t bytes_per_part = 64;

  /// Throws std::bad_alloc if zlib fails: the buffer is large enough, so that lack of memory is the only possible
  /// cause.
  static void check(bool good) {
    if (!good) throw std::bad_alloc();
  }

  std::vector<unsigned char> bytes_;
  z_stream stream_{};
};

/// Compresses `count` values; the chunk is filled with zeros beyond them. Bytes of equal significance are stored
/// together. The least significant bytes of measured numbers are noise, and searching them for repetitions took most of
/// the time.
std::vector<unsigned char> deflate_values(unsigned char const* values, std::size_t count, std::size_t value_bytes,
                                          std::size_t chunk_values) {
  std::vector<unsigned char> shuffled(chunk_values * value_bytes);
  Deflation deflation(shuffled.size(), value_bytes);
  for (std::size_t byte = 0; byte < value_bytes; ++byte) {
    std::span<unsigned char> const part(shuffled.data() + byte * chunk_values, chunk_values);
    for (std::size_t i = 0; i < count; ++i) part[i] = values[i * value_bytes + byte];
    deflation.add(part, byte + 1 == value_bytes);
  }
  return std::move(deflation).finish();
}

constexpr std::size_t most_known = 32;  // datasets that are retained for comparison, at most 1 MiB each

std::vector<DeflatedChunk> deflate_all(unsigned char const* bytes, std::vector<std::size_t> const& shape,
                                       std::vector<std::size_t> const& chunk, std::size_t value_bytes) {
  std::vector<DeflatedChunk> chunks;
  std::size_t const chunk_values = hdf5::product(chunk);
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
  for (std::size_t axis = 0; axis < chunk.size() && hdf5::product(chunk) * value_bytes > max_chunk_bytes;) {
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
  std::span<unsigned char const> const values(bytes, hdf5::product(shape) * value_bytes);
  std::vector<std::size_t> const start(shape.size(), 0);
  for (Known const& known : known_)
    if (std::equal(values.begin(), values.end(), known.values.begin(), known.values.end()))
      return {{start, known.deflated}};
  std::vector<DeflatedChunk> chunks = deflate_all(bytes, shape, chunk, value_bytes);
  if (retains_ && known_.size() < most_known)
    known_.push_back({std::vector<unsigned char>(values.begin(), values.end()), chunks.front().bytes});
  return chunks;
}

}  // namespace gladstone::inline files
