#include "render/files/fields/readers/vtk_payload.h"

#include <fmt/format.h>
#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <span>
#include <string_view>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

[[noreturn]] void refuse_damaged(InputFile const& file, std::string const& name, std::string const& why) {
  throw DataError(ErrorCode::damaged, file.path(),
                  fmt::format("data array \"{}\" is damaged ({}); copy it again", excerpt(name), why));
}

/// Sequential reader of the stored bytes of an array, decoding base64.
class ByteStream {
 public:
  ByteStream(VtkPayload const& payload, InputFile const& file, std::string const& name)
      : payload_(payload), file_(file), name_(name), end_(payload.appended ? file.size() : payload.text.size()) {
    at_ = payload.appended ? payload.offset : 0;
    if (at_ > end_) cut_short();
    if (payload.appended) return;
    buffer_ = payload.text;
    at_ = end_;
  }

  /// Returns the next `size` bytes. @throws DataError if there are fewer
  std::vector<char> next(std::uint64_t size) {
    std::uint64_t const left = end_ - at_ + (buffer_.size() - buffered_);
    if (size > (payload_.format == VtkPayload::Format::base64 ? left / 4 * 3 + 6 : left)) cut_short();
    require_memory(file_.path(), "data array \"" + excerpt(name_) + '"', static_cast<double>(size));
    std::vector<char> bytes(size);
    if (payload_.format == VtkPayload::Format::base64) {
      for (char& byte : bytes) byte = next_decoded();
    } else if (file_.read(at_, bytes.data(), size) < size) {
      cut_short();
    } else {
      at_ += size;
    }
    return bytes;
  }

 private:
  [[noreturn]] void cut_short() const {
    throw DataError(ErrorCode::damaged, file_.path(),
                    fmt::format("is cut short: data array \"{}\" is incomplete; copy it again", excerpt(name_)));
  }

  char next_decoded() {
    if (given_ == decoded_) decode_group();
    return group_[given_++];
  }

  /// Decodes the next four base64 digits. Padding ends a block; another block may follow.
  void decode_group() {
    std::uint32_t bits = 0;
    std::size_t digits = 0, padding = 0;
    while (digits + padding < 4) {
      int const c = next_character();
      if (c == '=') {
        ++padding;
        bits <<= 6;
        continue;
      }
      int const six = c < 0 ? -1 : value_of(static_cast<unsigned char>(c));
      if (c < 0 || c == '<') cut_short();
      if (six < 0 || padding > 0) refuse_damaged(file_, name_, "its base64 text contains invalid characters");
      bits = bits << 6 | static_cast<std::uint32_t>(six);
      ++digits;
    }
    if (digits < 2) refuse_damaged(file_, name_, "its base64 text contains invalid characters");
    for (std::size_t k = 0; k < 3; ++k) group_[k] = static_cast<char>(bits >> (16 - 8 * k));
    decoded_ = digits - 1;
    given_ = 0;
  }

  /// Returns the next character that is not white space; -1 at the end.
  int next_character() {
    while (true) {
      if (buffered_ == buffer_.size()) {
        if (at_ >= end_) return -1;
        throw_if_interrupted();
        constexpr std::uint64_t at_once = 1 << 18;
        buffer_.resize(std::min(at_once, end_ - at_));
        buffer_.resize(file_.read(at_, buffer_.data(), buffer_.size()));
        if (buffer_.empty()) return -1;
        at_ += buffer_.size();
        buffered_ = 0;
      }
      char const c = buffer_[buffered_++];
      if (c != ' ' && c != '\t' && c != '\r' && c != '\n') return static_cast<unsigned char>(c);
    }
  }

  static int value_of(unsigned char c) {
    static std::array<signed char, 256> const values = [] {
      constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      std::array<signed char, 256> table{};
      table.fill(-1);
      for (std::size_t i = 0; i < alphabet.size(); ++i) {
        table[static_cast<unsigned char>(alphabet[i])] = static_cast<signed char>(i);
      }
      return table;
    }();
    return values[c];
  }

  VtkPayload const& payload_;
  InputFile const& file_;
  std::string const& name_;
  std::uint64_t at_ = 0, end_;  ///< offset of the next byte to buffer, and end of the data
  std::string buffer_;          ///< base64 characters: part of the file, or all inline text
  std::size_t buffered_ = 0;    ///< number of characters of buffer_ that are decoded
  std::array<char, 3> group_{};
  std::size_t given_ = 0, decoded_ = 0;
};

/// Reads integer `index` of a length header.
std::uint64_t length_at(std::vector<char> const& bytes, std::size_t index, VtkEncoding const& encoding) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < encoding.length_bytes; ++i) {
    std::size_t const place = encoding.big_endian ? encoding.length_bytes - 1 - i : i;
    value |= std::uint64_t{static_cast<unsigned char>(bytes[index * encoding.length_bytes + place])} << (8 * i);
  }
  return value;
}

/// Decompresses a block.
/// @return number of decompressed bytes; nullopt if the block is damaged or larger than `out`
std::optional<std::uint64_t> decompress(VtkEncoding::Compressor compressor, std::span<char const> packed,
                                        std::span<char> out) {
  switch (compressor) {
    case VtkEncoding::Compressor::zlib: {
      uLongf room = out.size();
      int const result = uncompress(reinterpret_cast<Bytef*>(out.data()), &room,
                                    reinterpret_cast<Bytef const*>(packed.data()), packed.size());
      if (result != Z_OK) return std::nullopt;
      return room;
    }
    case VtkEncoding::Compressor::lz4: {
      constexpr std::size_t most = std::numeric_limits<int>::max();
      if (packed.size() > most) return std::nullopt;
      int const size = LZ4_decompress_safe(packed.data(), out.data(), static_cast<int>(packed.size()),
                                           static_cast<int>(std::min(out.size(), most)));
      if (size < 0) return std::nullopt;
      return static_cast<std::uint64_t>(size);
    }
    case VtkEncoding::Compressor::lzma: {
      std::uint64_t memory = std::uint64_t{1} << 30;
      std::size_t in = 0, written = 0;
      lzma_ret const result =
          lzma_stream_buffer_decode(&memory, 0, nullptr, reinterpret_cast<std::uint8_t const*>(packed.data()), &in,
                                    packed.size(), reinterpret_cast<std::uint8_t*>(out.data()), &written, out.size());
      if (result != LZMA_OK) return std::nullopt;
      return written;
    }
    case VtkEncoding::Compressor::none:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::vector<char> decode_bytes(VtkPayload const& payload, VtkEncoding const& encoding, InputFile const& file,
                               std::string const& name, std::uint64_t size) {
  auto const check_length = [&](std::uint64_t there) {
    if (there == size) return;
    refuse_damaged(file, name, fmt::format("its length is {}, but its grid needs {}", there, size));
  };
  ByteStream stream(payload, file, name);
  if (encoding.compressor == VtkEncoding::Compressor::none) {
    check_length(length_at(stream.next(encoding.length_bytes), 0, encoding));
    return stream.next(size);
  }
  // Header: number of blocks, block size, size of a partial last block (or 0), then the compressed size of each block.
  auto const header = stream.next(3 * encoding.length_bytes);
  std::uint64_t const blocks = length_at(header, 0, encoding), block = length_at(header, 1, encoding),
                      partial = length_at(header, 2, encoding);
  double const whole = static_cast<double>(blocks - (blocks > 0 && partial > 0 ? 1 : 0)) * static_cast<double>(block);
  check_length(whole + static_cast<double>(partial) > 9e18 ? 0 : static_cast<std::uint64_t>(whole) + partial);
  if (blocks > file.size()) refuse_damaged(file, name, "it declares more blocks than the file has bytes");
  auto const sizes = stream.next(blocks * encoding.length_bytes);
  require_memory(file.path(), "data array \"" + excerpt(name) + '"', static_cast<double>(size));
  std::vector<char> bytes(size);
  std::uint64_t done = 0;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    throw_if_interrupted();
    auto const packed = stream.next(length_at(sizes, i, encoding));
    std::uint64_t const room = std::min(block, size - done);
    auto const got = decompress(encoding.compressor, packed, std::span(bytes).subspan(done, room));
    if (!got) refuse_damaged(file, name, fmt::format("block {} of {} cannot be decompressed", i + 1, blocks));
    done += *got;
  }
  if (done != size) refuse_damaged(file, name, "it is shorter than its header declares");
  return bytes;
}

std::vector<double> decode_text(VtkPayload const& payload, InputFile const& file, std::string const& name,
                                std::uint64_t count) {
  std::string_view const text = payload.text;
  if (count > text.size()) {
    refuse_damaged(file, name, fmt::format("its length is {}, but its grid needs {}", text.size(), count));
  }
  require_memory(file.path(), "data array \"" + excerpt(name) + '"', static_cast<double>(count) * sizeof(double));
  std::vector<double> values;
  values.reserve(count);
  char const* at = text.data();
  char const* const end = at + text.size();
  auto const skip = [&] {
    while (at != end && std::string_view(" \t\r\n").find(*at) != std::string_view::npos) ++at;
    if (at != end && *at == '+') ++at;
  };
  for (skip(); at != end; skip()) {
    double value = 0;
    auto const [rest, error] = std::from_chars(at, end, value);
    if (error == std::errc::invalid_argument || values.size() == count) break;
    values.push_back(value);
    at = rest;
  }
  if (values.size() < count) {
    refuse_damaged(file, name, fmt::format("{} of {} numbers are present", values.size(), count));
  }
  if (at != end) refuse_damaged(file, name, fmt::format("it contains more than the {} numbers of its grid", count));
  return values;
}

}  // namespace gladstone::inline files
