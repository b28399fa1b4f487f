#include "render/files/fields/readers/byte_range.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Largest ratio of decompressed to compressed size of deflate (zlib, "Maximum Compression Factor").
constexpr std::uint64_t most_deflated = 1032;

/// Decompresses a range into `out`. @return number of bytes written
std::size_t inflate_range(ByteRange const& range, std::vector<char>& out) {
  z_stream stream{};
  constexpr int window_bits = 15;  // negative: deflate without the header of zlib
  if (inflateInit2(&stream, range.coding == ByteRange::Coding::zlib ? window_bits : -window_bits) != Z_OK) {
    throw DataError(ErrorCode::memory, range.file->path(),
                    "cannot be decompressed (out of memory); use a machine with more memory");
  }
  auto const close = [](z_stream* opened) { inflateEnd(opened); };
  std::unique_ptr<z_stream, decltype(close)> const guard(&stream, close);
  std::vector<unsigned char> in(256 * 1024);
  std::size_t done = 0;
  for (std::uint64_t from = 0; done < out.size();) {
    throw_if_interrupted();
    if (stream.avail_in == 0) {
      std::size_t const wanted = std::min<std::uint64_t>(in.size(), range.size - from);
      std::size_t const got = range.file->read(range.offset + from, in.data(), wanted);
      if (got == 0) return done;
      from += got;
      stream.next_in = in.data();
      stream.avail_in = static_cast<unsigned>(got);
    }
    std::size_t const room = std::min<std::size_t>(out.size() - done, 1 << 26);
    stream.next_out = reinterpret_cast<unsigned char*>(out.data() + done);
    stream.avail_out = static_cast<unsigned>(room);
    int const result = inflate(&stream, Z_NO_FLUSH);
    done += room - stream.avail_out;
    if (result == Z_STREAM_END) return done;
    if (result != Z_OK && result != Z_BUF_ERROR) {
      throw DataError(ErrorCode::damaged, range.file->path(),
                      fmt::format("array \"{}\" is damaged ({}); copy it again", excerpt(range.name),
                                  stream.msg ? stream.msg : "it cannot be decompressed"));
    }
  }
  return done;
}

}  // namespace

std::uint64_t most_bytes(ByteRange const& range) {
  return range.coding == ByteRange::Coding::stored ? range.size : most_deflated * range.size + 1024;
}

std::vector<char> read_up_to(ByteRange const& range, std::uint64_t count) {
  bool const stored = range.coding == ByteRange::Coding::stored;
  std::uint64_t const possible = most_bytes(range);
  require_memory(range.file->path(), "array \"" + excerpt(range.name) + '"',
                 static_cast<double>(std::min(count, possible)));
  std::vector<char> bytes(std::min(count, possible));
  bytes.resize(stored ? range.file->read(range.offset, bytes.data(), bytes.size()) : inflate_range(range, bytes));
  return bytes;
}

void refuse_truncated(ByteRange const& range, std::uint64_t present, std::uint64_t required) {
  std::uint64_t const file_size = range.file->size();
  bool const compressed = range.coding != ByteRange::Coding::stored;
  bool const whole = range.offset <= file_size && range.size <= file_size - range.offset;
  throw DataError(ErrorCode::damaged, range.file->path(),
                  fmt::format("is {}: array \"{}\" has {} bytes of data{}, and its header requires {}; copy it again",
                              compressed && whole ? "damaged" : "cut short", excerpt(range.name), present,
                              compressed ? " after decompression" : "", required));
}

}  // namespace gladstone::inline files
