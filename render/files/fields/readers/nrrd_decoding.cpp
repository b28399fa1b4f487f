#include "render/files/fields/readers/nrrd_decoding.h"

#include <bzlib.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <memory>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

using Encoding = NrrdHeader::Encoding;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// Returns the value of a hexadecimal digit; -1 for other characters.
int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::size_t values_of(NrrdHeader const& header) { return header.data_bytes() / header.value_bytes(); }

char const* encoding_name(NrrdHeader const& header) {
  return header.encoding == Encoding::bzip2 ? "bzip2" : header.encoding == Encoding::hex ? "hex" : "text";
}

[[noreturn]] void refuse_too_few_numbers(NrrdHeader const& header, std::size_t there) {
  throw DataError(ErrorCode::damaged, header.data_path,
                  fmt::format("is cut short: {} numbers are present and {} are needed (sizes {}); copy it again", there,
                              values_of(header), header.sizes_text()));
}

/// Decodes numbers separated by blanks and commas, as doubles.
std::vector<char> decode_numbers(NrrdHeader const& header, std::string const& text) {
  std::vector<char> decoded(nrrd_decoded_bytes(header));
  char const* at = text.data();
  char const* const end = at + text.size();
  auto const skip = [&] {
    while (at != end && (is_blank(*at) || *at == ',')) ++at;
  };
  std::size_t const count = values_of(header);
  for (std::size_t i = 0; i < count; ++i) {
    skip();
    double value = 0;
    if (at != end && *at == '+') ++at;
    auto const [rest, error] = std::from_chars(at, end, value);
    if (at == end) refuse_too_few_numbers(header, i);
    if (error == std::errc::invalid_argument) {
      throw DataError(ErrorCode::damaged, header.data_path,
                      fmt::format("is damaged: number {} of its text is \"{}\"; copy it again", i + 1,
                                  excerpt(std::string(at, std::find_if(at, end, is_blank)))));
    }
    std::memcpy(decoded.data() + i * sizeof value, &value, sizeof value);
    at = rest;
  }
  skip();
  if (at != end) {
    throw DataError(
        ErrorCode::damaged, header.data_path,
        fmt::format("holds more than the {} numbers of its sizes {}; correct the sizes", count, header.sizes_text()));
  }
  return decoded;
}

/// Decodes pairs of hexadecimal digits.
std::vector<char> decode_hex(NrrdHeader const& header, std::string const& text) {
  std::vector<char> decoded(nrrd_decoded_bytes(header));
  std::size_t digits = 0;
  for (char const c : text) {
    if (is_blank(c)) continue;
    int const digit = hex_digit(c);
    if (digit < 0) {
      throw DataError(
          ErrorCode::damaged, header.data_path,
          fmt::format("is damaged: digit {} of its hex data is not a hexadecimal digit; copy it again", digits + 1));
    }
    if (digits / 2 < decoded.size()) {
      char& byte = decoded[digits / 2];
      byte = static_cast<char>(digits % 2 == 0 ? digit << 4 : static_cast<unsigned char>(byte) | digit);
    }
    ++digits;
  }
  if (digits / 2 < decoded.size()) refuse_cut_short(header, digits / 2);
  if (digits > 2 * decoded.size()) refuse_too_long(header, digits / 2);
  return decoded;
}

/// Decompresses a bzip2 stream and drops the first byte_skip bytes of the result.
std::vector<char> decode_bzip2(NrrdHeader const& header, std::string const& packed) {
  std::vector<char> decoded(nrrd_decoded_bytes(header));
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    throw DataError(ErrorCode::memory, header.data_path,
                    "cannot be decompressed (out of memory); use a machine with more memory");
  }
  auto const close = [](bz_stream* opened) { BZ2_bzDecompressEnd(opened); };
  std::unique_ptr<bz_stream, decltype(close)> const guard(&stream, close);
  constexpr std::size_t most = 64 * 1024 * 1024;
  std::vector<char> skipped(static_cast<std::size_t>(std::min<long long>(header.byte_skip, 1 << 20)));
  std::size_t to_skip = static_cast<std::size_t>(header.byte_skip), in = 0, out = 0;
  bool ended = false;
  std::array<char, 16> beyond{};
  std::size_t surplus = 0;
  while (!ended) {
    throw_if_interrupted();
    if (stream.avail_in == 0) {
      stream.next_in = const_cast<char*>(packed.data() + in);  // bzlib does not modify its input
      stream.avail_in = static_cast<unsigned>(std::min(most, packed.size() - in));
      in += stream.avail_in;
    }
    bool const skipping = to_skip > 0, full = !skipping && out == decoded.size();
    char* const to = skipping ? skipped.data() : full ? beyond.data() : decoded.data() + out;
    std::size_t const room = skipping ? std::min(skipped.size(), to_skip)
                             : full   ? beyond.size()
                                      : std::min(most, decoded.size() - out);
    stream.next_out = to;
    stream.avail_out = static_cast<unsigned>(room);
    unsigned const had = stream.avail_in;
    int const result = BZ2_bzDecompress(&stream);
    if (result != BZ_OK && result != BZ_STREAM_END) {
      throw DataError(ErrorCode::damaged, header.data_path, "is damaged (bzip2 cannot decompress it); copy it again");
    }
    std::size_t const got = room - stream.avail_out;
    if (skipping) to_skip -= got;
    if (full) surplus += got;
    if (!skipping && !full) out += got;
    if (surplus > 0) refuse_too_long(header, decoded.size() + surplus);
    ended = result == BZ_STREAM_END;
    if (!ended && got == 0 && stream.avail_in == had && in == packed.size()) refuse_cut_short(header, out);
  }
  if (out < decoded.size()) refuse_cut_short(header, out);
  return decoded;
}

}  // namespace

std::size_t nrrd_decoded_bytes(NrrdHeader const& header) {
  return header.encoding == Encoding::ascii ? values_of(header) * sizeof(double) : header.data_bytes();
}

std::vector<char> decode_nrrd(NrrdHeader const& header, std::string const& stored) {
  // Limits of a plausible header: at most 8 values per byte of text or hex data, 8e6 per byte of bzip2 data.
  double const most = header.encoding == Encoding::bzip2 ? 1e6 : 1;
  if (static_cast<double>(values_of(header)) > most * 8 * static_cast<double>(stored.size())) {
    throw DataError(ErrorCode::damaged, header.data_path,
                    fmt::format("is cut short: its {} bytes of {} cannot hold {} values (sizes {}); copy it again, or "
                                "correct the sizes",
                                stored.size(), encoding_name(header), values_of(header), header.sizes_text()));
  }
  if (header.encoding == Encoding::ascii) return decode_numbers(header, stored);
  return header.encoding == Encoding::hex ? decode_hex(header, stored) : decode_bzip2(header, stored);
}

void refuse_cut_short(NrrdHeader const& header, std::size_t there) {
  throw DataError(ErrorCode::damaged, header.data_path,
                  fmt::format("is cut short: {} bytes of data are present and {} are needed (sizes {}, {} bytes per "
                              "value); copy it again",
                              there, header.data_bytes(), header.sizes_text(), header.value_bytes()));
}

void refuse_too_long(NrrdHeader const& header, std::size_t there) {
  throw DataError(ErrorCode::damaged, header.data_path,
                  fmt::format("holds more data than its header says: {} bytes or more are present and {} are needed "
                              "(sizes {}, {} bytes per value), so that the position of the field is unknown; correct "
                              "the sizes, or give \"byte skip\" if other data precede the field",
                              there, header.data_bytes(), header.sizes_text(), header.value_bytes()));
}

}  // namespace gladstone::inline files
