#include "render/files/fields/readers/nrrd_bytes.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/readers/nrrd_decoding.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {

NrrdBytes::NrrdBytes(NrrdHeader const& header) : header_(header), file_(header.data_path, "the data of a field") {
  try {
    offset_ = header_.data_offset;
    skip_lines();
    if (header_.encoding == NrrdHeader::Encoding::raw) prepare_raw();
    if (header_.encoding == NrrdHeader::Encoding::gzip) prepare_gzip();
  } catch (...) {
    close();
    throw;
  }
}

void NrrdBytes::read(std::size_t first, void* out, std::size_t size) {
  if (header_.encoding == NrrdHeader::Encoding::raw) {
    std::size_t const got = file_.read(offset_ + first, out, size);
    if (got < size) refuse_cut_short(header_, first + got);
    return;
  }
  if (header_.encoding != NrrdHeader::Encoding::gzip) {
    if (decoded_.empty()) decoded_ = decode_nrrd(header_, stored());
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

void NrrdBytes::close() {
  if (stream_) gzclose_r(stream_);
}

void NrrdBytes::skip_lines() {
  std::vector<char> block(64 * 1024);
  for (long lines = header_.line_skip; lines > 0;) {
    std::size_t const got = file_.read(offset_, block.data(), block.size());
    if (got == 0)
      throw DataError(ErrorCode::damaged, header_.data_path,
                      "is cut short: it ends within the lines that \"line skip\" excludes; copy it again, or correct "
                      "\"line skip\"");
    std::size_t used = 0;
    while (used < got && lines > 0) lines -= block[used++] == '\n';
    offset_ += used;
  }
}

void NrrdBytes::prepare_raw() {
  std::size_t const size = file_.size();
  std::size_t const needed = header_.data_bytes();
  if (header_.byte_skip >= 0) offset_ += static_cast<std::size_t>(header_.byte_skip);
  std::size_t const there = size > offset_ ? size - offset_ : 0;
  if (there < needed) refuse_cut_short(header_, there);
  if (header_.byte_skip == -1) offset_ = size - needed;
  bool const placed = header_.byte_skip != 0 || header_.line_skip != 0;  // the start of the data is unambiguous
  if (there > needed && !placed && !only_line_ends(offset_ + needed, there - needed)) refuse_too_long(header_, there);
}

bool NrrdBytes::only_line_ends(std::size_t offset, std::size_t size) const {
  std::array<char, 4> rest{};
  if (size > rest.size()) return false;
  std::size_t const got = file_.read(offset, rest.data(), size);
  return std::all_of(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(got),
                     [](char c) { return c == '\n' || c == '\r'; });
}

std::string NrrdBytes::stored() const {
  std::size_t const size = file_.size() > offset_ ? file_.size() - offset_ : 0;
  require_memory(header_.data_path, "its data",
                 static_cast<double>(size) + static_cast<double>(nrrd_decoded_bytes(header_)));
  std::string bytes(size, '\0');
  bytes.resize(file_.read(offset_, bytes.data(), size));
  if (header_.encoding != NrrdHeader::Encoding::bzip2) {
    bytes.erase(0, std::min(bytes.size(), static_cast<std::size_t>(header_.byte_skip)));
  }
  return bytes;
}

void NrrdBytes::prepare_gzip() {
  int const descriptor = ::dup(file_.descriptor());  // gzclose() closes its descriptor
  ::lseek(descriptor, static_cast<off_t>(offset_), SEEK_SET);
  stream_ = gzdopen(descriptor, "rb");
  if (!stream_) {
    ::close(descriptor);
    throw DataError(ErrorCode::memory, header_.data_path,
                    "cannot be decompressed (out of memory); use a machine with more memory");
  }
  gzbuffer(stream_, 256 * 1024);
  skipped_ = static_cast<std::size_t>(header_.byte_skip);
  char first = 0;
  int const got = gzread(stream_, &first, 1);
  if (got < 0) damaged();
  if (got == 0) refuse_cut_short(header_, 0);
  if (gzdirect(stream_))
    throw DataError(ErrorCode::damaged, header_.data_path,
                    "is not compressed by gzip, although its header says so; correct the field \"encoding\"");
  if (gzrewind(stream_) != 0) damaged();
  discard(skipped_);
  position_ = 0;
}

void NrrdBytes::inflate(char* out, std::size_t size) {
  constexpr std::size_t most = 64 * 1024 * 1024;
  while (size > 0) {
    throw_if_interrupted();
    int const got = gzread(stream_, out, static_cast<unsigned>(std::min(size, most)));
    if (got <= 0) {
      int problem = Z_OK;
      gzerror(stream_, &problem);
      if (problem != Z_OK && problem != Z_BUF_ERROR) damaged();
      refuse_cut_short(header_, position_);
    }
    out += got;
    size -= static_cast<std::size_t>(got);
    position_ += static_cast<std::size_t>(got);
  }
}

void NrrdBytes::discard(std::size_t size) {
  std::vector<char> scratch(std::min<std::size_t>(size, 1024 * 1024));
  while (size > 0) {
    std::size_t const part = std::min(size, scratch.size());
    inflate(scratch.data(), part);
    size -= part;
  }
}

void NrrdBytes::check_end() {
  std::array<char, 4096> beyond{};
  int const got = gzread(stream_, beyond.data(), static_cast<unsigned>(beyond.size()));
  if (got < 0) damaged();
  auto const end = beyond.begin() + std::max(got, 0);
  bool const line_end = got <= 4 && std::all_of(beyond.begin(), end, [](char c) { return c == '\n' || c == '\r'; });
  if (got > 0 && header_.byte_skip == 0 && !line_end)
    refuse_too_long(header_, header_.data_bytes() + static_cast<std::size_t>(got));
  // reading is no longer sequential: later reads restart from the beginning
  position_ = std::numeric_limits<std::size_t>::max();
}

void NrrdBytes::damaged() const {
  int problem = Z_OK;
  std::string const why = stream_ ? gzerror(stream_, &problem) : "";
  throw DataError(ErrorCode::damaged, header_.data_path, "is damaged (" + why + "); copy it again");
}

}  // namespace gladstone::inline files
