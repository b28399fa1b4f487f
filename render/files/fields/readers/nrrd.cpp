#include "render/files/fields/readers/nrrd.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <limits>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/readers/checked_source.h"
#include "render/files/fields/readers/nrrd_header.h"
#include "render/files/input_file.h"
#include "render/files/text_file.h"

namespace gladstone {
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

/// Random access to the bytes of the data section: raw data by pread, gzip data by zlib; other encodings are decoded
/// into memory at the first access, text as doubles.
class NrrdBytes {
 public:
  explicit NrrdBytes(NrrdHeader const& header) : header_(header), file_(header.data_path, "the data of a field") {
    try {
      offset_ = header_.data_offset;
      skip_lines();
      if (header_.encoding == Encoding::raw) prepare_raw();
      if (header_.encoding == Encoding::gzip) prepare_gzip();
    } catch (...) {
      close();
      throw;
    }
  }
  ~NrrdBytes() { close(); }
  NrrdBytes(NrrdBytes const&) = delete;
  NrrdBytes& operator=(NrrdBytes const&) = delete;

  /// Reads bytes [first, first + size) of the decoded field.
  void read(std::size_t first, void* out, std::size_t size) {
    if (header_.encoding == Encoding::raw) {
      std::size_t const got = file_.read(offset_ + first, out, size);
      if (got < size) cut_short(first + got);
      return;
    }
    if (header_.encoding != Encoding::gzip) {
      if (decoded_.empty()) decode();
      std::memcpy(out, decoded_.data() + first, size);
      return;
    }
    if (first < position_) {
      if (gzrewind(stream_) != 0) damaged();
      position_ = 0;
      discard(skipped_);
      position_ = 0;
    }
    discard(first - position_);
    inflate(static_cast<char*>(out), size);
    if (position_ == header_.data_bytes()) check_end();
  }

 private:
  void close() {
    if (stream_) gzclose_r(stream_);
  }

  void skip_lines() {
    std::vector<char> block(64 * 1024);
    for (long lines = header_.line_skip; lines > 0;) {
      std::size_t const got = file_.read(offset_, block.data(), block.size());
      if (got == 0) throw DataError(header_.data_path, "ends within the lines to be skipped by \"line skip\"");
      std::size_t used = 0;
      while (used < got && lines > 0) lines -= block[used++] == '\n';
      offset_ += used;
    }
  }

  /// Finds the offset of raw data and checks their length.
  void prepare_raw() {
    std::size_t const size = file_.size();
    std::size_t const needed = header_.data_bytes();
    if (header_.byte_skip >= 0) offset_ += static_cast<std::size_t>(header_.byte_skip);
    std::size_t const there = size > offset_ ? size - offset_ : 0;
    if (there < needed) cut_short(there);
    if (header_.byte_skip == -1) offset_ = size - needed;
    bool const placed = header_.byte_skip != 0 || header_.line_skip != 0;  // the start of the data is unambiguous
    if (there > needed && !placed && !only_line_ends(offset_ + needed, there - needed)) too_long(there);
  }

  /// Returns true if a part of the file contains only line ends, as added by an editor.
  bool only_line_ends(std::size_t offset, std::size_t size) const {
    std::array<char, 4> rest{};
    if (size > rest.size()) return false;
    std::size_t const got = file_.read(offset, rest.data(), size);
    return std::all_of(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(got),
                       [](char c) { return c == '\n' || c == '\r'; });
  }

  /// Returns the encoded data section, without the bytes to be skipped (bzip2: skipped after decompression).
  std::string stored() const {
    std::size_t const size = file_.size() > offset_ ? file_.size() - offset_ : 0;
    require_memory(header_.data_path, "its data", static_cast<double>(size) + static_cast<double>(decoded_bytes()));
    std::string bytes(size, '\0');
    bytes.resize(file_.read(offset_, bytes.data(), size));
    if (header_.encoding != Encoding::bzip2) {
      bytes.erase(0, std::min(bytes.size(), static_cast<std::size_t>(header_.byte_skip)));
    }
    return bytes;
  }

  std::size_t values() const { return header_.data_bytes() / header_.value_bytes(); }
  std::size_t decoded_bytes() const {
    return header_.encoding == Encoding::ascii ? values() * sizeof(double) : header_.data_bytes();
  }

  char const* encoding_name() const {
    return header_.encoding == Encoding::bzip2 ? "bzip2" : header_.encoding == Encoding::hex ? "hex" : "text";
  }

  void decode() {
    std::string const bytes = stored();
    // Limits of a plausible header: at most 8 values per byte of text or hex data, 8e6 per byte of bzip2 data.
    double const most = header_.encoding == Encoding::bzip2 ? 1e6 : 1;
    if (static_cast<double>(values()) > most * 8 * static_cast<double>(bytes.size())) {
      throw DataError(
          header_.data_path,
          fmt::format("is cut short: its {} bytes of {} cannot hold {} values (sizes {}); copy it again, or "
                      "correct the sizes",
                      bytes.size(), encoding_name(), values(), header_.sizes_text()));
    }
    decoded_.resize(decoded_bytes());
    try {
      if (header_.encoding == Encoding::ascii) decode_text(bytes);
      if (header_.encoding == Encoding::hex) decode_hex(bytes);
      if (header_.encoding == Encoding::bzip2) decode_bzip2(bytes);
    } catch (...) {
      decoded_.clear();
      throw;
    }
  }

  void decode_text(std::string const& text) {
    char const* at = text.data();
    char const* const end = at + text.size();
    auto const skip = [&] {
      while (at != end && (is_blank(*at) || *at == ',')) ++at;
    };
    std::size_t const count = values();
    for (std::size_t i = 0; i < count; ++i) {
      skip();
      double value = 0;
      if (at != end && *at == '+') ++at;
      auto const [rest, error] = std::from_chars(at, end, value);
      if (at == end) too_few_numbers(i);
      if (error == std::errc::invalid_argument) {
        throw DataError(header_.data_path,
                        fmt::format("is damaged: number {} of its text is \"{}\"; copy it again", i + 1,
                                    excerpt(std::string(at, std::find_if(at, end, is_blank)))));
      }
      std::memcpy(decoded_.data() + i * sizeof value, &value, sizeof value);
      at = rest;
    }
    skip();
    if (at != end) {
      throw DataError(header_.data_path,
                      fmt::format("holds more than the {} numbers of its sizes {}; correct the sizes", count,
                                  header_.sizes_text()));
    }
  }

  [[noreturn]] void too_few_numbers(std::size_t there) const {
    throw DataError(header_.data_path,
                    fmt::format("is cut short: {} numbers are present and {} are needed (sizes {}); copy it again",
                                there, values(), header_.sizes_text()));
  }

  void decode_hex(std::string const& text) {
    std::size_t digits = 0;
    for (char const c : text) {
      if (is_blank(c)) continue;
      int const digit = hex_digit(c);
      if (digit < 0) {
        throw DataError(
            header_.data_path,
            fmt::format("is damaged: digit {} of its hex data is not a hexadecimal digit; copy it again", digits + 1));
      }
      if (digits / 2 < decoded_.size()) {
        char& byte = decoded_[digits / 2];
        byte = static_cast<char>(digits % 2 == 0 ? digit << 4 : static_cast<unsigned char>(byte) | digit);
      }
      ++digits;
    }
    if (digits / 2 < decoded_.size()) cut_short(digits / 2);
    if (digits > 2 * decoded_.size()) too_long(digits / 2);
  }

  void decode_bzip2(std::string const& packed) {
    bz_stream stream{};
    if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
      throw MemoryError(header_.data_path, "cannot be decompressed (out of memory)");
    }
    auto const close = [](bz_stream* opened) { BZ2_bzDecompressEnd(opened); };
    std::unique_ptr<bz_stream, decltype(close)> const guard(&stream, close);
    constexpr std::size_t most = 64 * 1024 * 1024;
    std::vector<char> skipped(static_cast<std::size_t>(std::min<long long>(header_.byte_skip, 1 << 20)));
    std::size_t to_skip = static_cast<std::size_t>(header_.byte_skip), in = 0, out = 0;
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
      bool const skipping = to_skip > 0, full = !skipping && out == decoded_.size();
      char* const to = skipping ? skipped.data() : full ? beyond.data() : decoded_.data() + out;
      std::size_t const room = skipping ? std::min(skipped.size(), to_skip)
                               : full   ? beyond.size()
                                        : std::min(most, decoded_.size() - out);
      stream.next_out = to;
      stream.avail_out = static_cast<unsigned>(room);
      unsigned const had = stream.avail_in;
      int const result = BZ2_bzDecompress(&stream);
      if (result != BZ_OK && result != BZ_STREAM_END) {
        throw DataError(header_.data_path, "is damaged (bzip2 cannot decompress it); copy it again");
      }
      std::size_t const got = room - stream.avail_out;
      if (skipping) to_skip -= got;
      if (full) surplus += got;
      if (!skipping && !full) out += got;
      if (surplus > 0) too_long(decoded_.size() + surplus);
      ended = result == BZ_STREAM_END;
      if (!ended && got == 0 && stream.avail_in == had && in == packed.size()) cut_short(out);
    }
    if (out < decoded_.size()) cut_short(out);
  }

  /// Opens the gzip stream and moves to the first value.
  void prepare_gzip() {
    int const descriptor = ::dup(file_.descriptor());  // gzclose() closes its descriptor
    ::lseek(descriptor, static_cast<off_t>(offset_), SEEK_SET);
    stream_ = gzdopen(descriptor, "rb");
    if (!stream_) {
      ::close(descriptor);
      throw MemoryError(header_.data_path, "cannot be decompressed (out of memory)");
    }
    gzbuffer(stream_, 256 * 1024);
    skipped_ = static_cast<std::size_t>(header_.byte_skip);
    char first = 0;
    int const got = gzread(stream_, &first, 1);
    if (got < 0) damaged();
    if (got == 0) cut_short(0);
    if (gzdirect(stream_)) throw DataError(header_.data_path, "is declared as gzip, but is not compressed by gzip");
    if (gzrewind(stream_) != 0) damaged();
    discard(skipped_);
    position_ = 0;
  }

  void inflate(char* out, std::size_t size) {
    constexpr std::size_t most = 64 * 1024 * 1024;
    while (size > 0) {
      throw_if_interrupted();
      int const got = gzread(stream_, out, static_cast<unsigned>(std::min(size, most)));
      if (got <= 0) {
        int problem = Z_OK;
        gzerror(stream_, &problem);
        if (problem != Z_OK && problem != Z_BUF_ERROR) damaged();
        cut_short(position_);
      }
      out += got;
      size -= static_cast<std::size_t>(got);
      position_ += static_cast<std::size_t>(got);
    }
  }

  void discard(std::size_t size) {
    std::vector<char> scratch(std::min<std::size_t>(size, 1024 * 1024));
    while (size > 0) {
      std::size_t const part = std::min(size, scratch.size());
      inflate(scratch.data(), part);
      size -= part;
    }
  }

  /// Reads past the last value, which makes zlib verify its checksum, and checks that no further data follow.
  void check_end() {
    std::array<char, 4096> beyond{};
    int const got = gzread(stream_, beyond.data(), static_cast<unsigned>(beyond.size()));
    if (got < 0) damaged();
    auto const end = beyond.begin() + std::max(got, 0);
    bool const line_end = got <= 4 && std::all_of(beyond.begin(), end, [](char c) { return c == '\n' || c == '\r'; });
    if (got > 0 && header_.byte_skip == 0 && !line_end) too_long(header_.data_bytes() + static_cast<std::size_t>(got));
    position_ = std::numeric_limits<std::size_t>::max();  // later reads restart from the beginning
  }

  [[noreturn]] void damaged() const {
    int problem = Z_OK;
    std::string const why = stream_ ? gzerror(stream_, &problem) : "";
    throw DataError(header_.data_path, "is damaged (" + why + "); copy it again");
  }

  [[noreturn]] void cut_short(std::size_t there) const {
    throw DataError(header_.data_path,
                    fmt::format("is cut short: {} bytes of data are present and {} are needed (sizes {}, {} bytes per "
                                "value); copy it again",
                                there, header_.data_bytes(), header_.sizes_text(), header_.value_bytes()));
  }

  [[noreturn]] void too_long(std::size_t there) const {
    throw DataError(header_.data_path,
                    fmt::format("holds more data than its header says: {} bytes or more are present and {} are needed "
                                "(sizes {}, {} bytes per value), so that the position of the field is unknown; correct "
                                "the sizes, or give \"byte skip\" if other data precede the field",
                                there, header_.data_bytes(), header_.sizes_text(), header_.value_bytes()));
  }

  NrrdHeader const& header_;
  InputFile file_;
  gzFile stream_ = nullptr;
  std::size_t offset_ = 0;     ///< offset of the first value in the stored file [bytes]
  std::size_t skipped_ = 0;    ///< decompressed bytes before the first value
  std::size_t position_ = 0;   ///< position of the gzip stream after the first value [decompressed bytes]
  std::vector<char> decoded_;  ///< all decoded bytes, for encodings held in memory
};

template <class Stored>
void convert(std::vector<char> const& bytes, bool swap, std::span<double> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::array<char, sizeof(Stored)> value;
    std::copy_n(bytes.data() + i * sizeof(Stored), sizeof(Stored), value.data());
    if (swap) std::reverse(value.begin(), value.end());
    out[i] = static_cast<double>(std::bit_cast<Stored>(value));
  }
}

void convert(NrrdHeader::Type type, std::vector<char> const& bytes, bool swap, std::span<double> out) {
  using Type = NrrdHeader::Type;
  switch (type) {
    case Type::int8:
      return convert<std::int8_t>(bytes, swap, out);
    case Type::uint8:
      return convert<std::uint8_t>(bytes, swap, out);
    case Type::int16:
      return convert<std::int16_t>(bytes, swap, out);
    case Type::uint16:
      return convert<std::uint16_t>(bytes, swap, out);
    case Type::int32:
      return convert<std::int32_t>(bytes, swap, out);
    case Type::uint32:
      return convert<std::uint32_t>(bytes, swap, out);
    case Type::int64:
      return convert<std::int64_t>(bytes, swap, out);
    case Type::uint64:
      return convert<std::uint64_t>(bytes, swap, out);
    case Type::float32:
      return convert<float>(bytes, swap, out);
    case Type::float64:
      return convert<double>(bytes, swap, out);
  }
}

class NrrdSource final : public CheckedSource {
 public:
  NrrdSource(std::string const& path, NrrdHeader header, FieldSelection const& selection)
      : CheckedSource(path, header.content.empty() ? std::filesystem::path(path).filename().string() : header.content,
                      selection.values),
        header_(std::move(header)),
        bytes_(header_) {
    units_ = header_.units;
    notes_ = header_.notes;
    axes_ = header_.axes;
    name_axes(axes_, selection.axes, header_.dimension, path);
    describe(header_.sizes, header_.dimension,
             !selection.axes.empty() ? "axes = \"" + selection.axes + '"'
             : header_.directed      ? "by its space directions"
             : header_.labelled      ? "by its labels"
                                     : "the default order");
  }

 private:
  int significant_bits() const override { return header_.significant_bits(); }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    bool const text = header_.encoding == Encoding::ascii;  // text is decoded to doubles
    std::size_t const bytes = text ? sizeof(double) : header_.value_bytes();
    std::size_t const row = row_values() * bytes;
    std::size_t const first = row * (static_cast<std::size_t>(plane) * static_cast<std::size_t>(nodes_[1]) +
                                     static_cast<std::size_t>(first_row));
    bool const swap = !text && header_.big_endian != (std::endian::native == std::endian::big);
    stored_.resize(row * static_cast<std::size_t>(count));
    bytes_.read(first, stored_.data(), stored_.size());
    convert(text ? NrrdHeader::Type::float64 : header_.type, stored_, swap, out);
  }

  NrrdHeader header_;
  NrrdBytes bytes_;
  std::vector<char> stored_;  ///< bytes of rows before conversion to double, reused between calls
};

}  // namespace

std::unique_ptr<CheckedSource> open_nrrd(std::string const& path, FieldSelection const& selection) {
  if (!selection.dataset.empty()) {
    throw DataError(path, "contains one field without a name; leave dataset = \"" + selection.dataset + "\" out");
  }
  return std::make_unique<NrrdSource>(path, read_nrrd_header(path, selection.values), selection);
}

}  // namespace gladstone
