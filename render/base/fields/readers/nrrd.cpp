#include "render/base/fields/readers/nrrd.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <limits>

#include "render/base/error.h"
#include "render/base/fields/readers/checked_source.h"
#include "render/base/fields/readers/nrrd_header.h"
#include "render/base/input_file.h"
#include "render/base/interrupt.h"

namespace gladstone {
namespace {

/// The data section as a stream of bytes: raw through pread, gzip through zlib.
class NrrdBytes {
 public:
  explicit NrrdBytes(NrrdHeader const& header) : header_(header), file_(header.data_path, "the data of a field") {
    try {
      offset_ = header_.data_offset;
      skip_lines();
      header_.encoding == NrrdHeader::Encoding::raw ? prepare_raw() : prepare_gzip();
    } catch (...) {
      close();
      throw;
    }
  }
  ~NrrdBytes() { close(); }
  NrrdBytes(NrrdBytes const&) = delete;
  NrrdBytes& operator=(NrrdBytes const&) = delete;

  /// Bytes [first, first + size) of the field.
  void read(std::size_t first, void* out, std::size_t size) {
    if (header_.encoding == NrrdHeader::Encoding::raw) {
      std::size_t const got = file_.read(offset_ + first, out, size);
      if (got < size) cut_short(first + got);
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
      if (got == 0) throw DataError(header_.data_path, "ends before the lines that \"line skip\" leaves out");
      std::size_t used = 0;
      while (used < got && lines > 0) lines -= block[used++] == '\n';
      offset_ += used;
    }
  }

  void prepare_raw() {
    std::size_t const size = file_.size();
    std::size_t const needed = header_.data_bytes();
    if (header_.byte_skip >= 0) offset_ += static_cast<std::size_t>(header_.byte_skip);
    std::size_t const there = size > offset_ ? size - offset_ : 0;
    if (there < needed) cut_short(there);
    if (header_.byte_skip == -1) offset_ = size - needed;
  }

  void prepare_gzip() {
    int const descriptor = ::dup(file_.descriptor());  // gzclose closes its own
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
    if (gzdirect(stream_)) throw DataError(header_.data_path, "is said to be gzip, and is not");
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

  /// Beyond the last value zlib compares its checksum.
  void check_end() {
    char beyond = 0;
    if (gzread(stream_, &beyond, 1) < 0) damaged();
    position_ = std::numeric_limits<std::size_t>::max();  // any further reading starts again
  }

  [[noreturn]] void damaged() const {
    int problem = Z_OK;
    std::string const why = stream_ ? gzerror(stream_, &problem) : "";
    throw DataError(header_.data_path, "is damaged (" + why + "); copy it again");
  }

  [[noreturn]] void cut_short(std::size_t there) const {
    throw DataError(header_.data_path,
                    fmt::format("is cut short: {} bytes of data are there and {} are needed (sizes {} x {} x {}, {} "
                                "bytes a value); copy it again",
                                there, header_.data_bytes(), header_.sizes[0], header_.sizes[1], header_.sizes[2],
                                header_.value_bytes()));
  }

  NrrdHeader const& header_;
  InputFile file_;
  gzFile stream_ = nullptr;
  std::size_t offset_ = 0;    ///< of the first value, in the stored file
  std::size_t skipped_ = 0;   ///< decompressed bytes before the first value
  std::size_t position_ = 0;  ///< of the stream, in decompressed bytes from the first value
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
  NrrdSource(std::string const& path, NrrdHeader header)
      : CheckedSource(path, header.content.empty() ? std::filesystem::path(path).filename().string() : header.content,
                      1),
        header_(std::move(header)),
        bytes_(header_) {
    grid_.nodes = header_.sizes;
    grid_.spacing = {header_.spacing[0], header_.spacing[1], header_.spacing[2]};
    units_ = header_.units;
    grid_.origin = {header_.origin[0], header_.origin[1], header_.origin[2]};
  }

 private:
  int significant_bits() const override { return header_.significant_bits(); }

  void read_raw_planes(int first_plane, int count, std::span<double> out) override {
    std::size_t const plane = header_.plane_bytes() / header_.value_bytes();
    for (int z = 0; z < count; ++z) {
      read_raw_rows(first_plane + z, 0, header_.sizes[1], out.subspan(static_cast<std::size_t>(z) * plane, plane));
    }
  }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    std::size_t const row_bytes = header_.value_bytes() * static_cast<std::size_t>(header_.sizes[0]);
    std::size_t const first =
        static_cast<std::size_t>(plane) * header_.plane_bytes() + static_cast<std::size_t>(first_row) * row_bytes;
    bool const swap = header_.big_endian != (std::endian::native == std::endian::big);
    stored_.resize(row_bytes * static_cast<std::size_t>(count));
    bytes_.read(first, stored_.data(), stored_.size());
    convert(header_.type, stored_, swap, out);
  }

  NrrdHeader header_;
  NrrdBytes bytes_;
  std::vector<char> stored_;  ///< kept, so that its memory is asked for once
};

}  // namespace

std::unique_ptr<FieldSource> open_nrrd(std::string const& path, std::string const& dataset, int values) {
  if (values != 1) {
    throw DataError(path, "NRRD files are read as scalar fields alone; write a velocity as .h5 or .vti");
  }
  if (!dataset.empty()) {
    throw DataError(path, "holds one field without a name; leave dataset = \"" + dataset + "\" out");
  }
  return std::make_unique<NrrdSource>(path, read_nrrd_header(path));
}

}  // namespace gladstone
