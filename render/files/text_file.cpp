#include "render/files/text_file.h"

#include <algorithm>
#include <cstring>
#include <new>

#include "render/files/text_encoding.h"

namespace gladstone::inline files {
namespace {

constexpr std::size_t most_line_bytes = std::size_t{1} << 20;

std::string mebibytes(std::uint64_t bytes) { return std::to_string(bytes >> 20) + " MiB"; }

}  // namespace

std::string read_text_file(std::string const& path, std::string const& wanted, std::uint64_t most_bytes) {
  InputFile const file(path, wanted);
  constexpr std::size_t piece = std::size_t{1} << 20;  // block size if the size is unknown (/proc)
  std::string text;
  try {
    while (true) {
      std::size_t const done = text.size();
      if (done > most_bytes || file.size() > most_bytes) {
        throw DataError(ErrorCode::out_of_range, path,
                        "is longer than " + mebibytes(most_bytes) + ", the maximum size; name " + wanted);
      }
      text.resize(done + std::max<std::size_t>(piece, done < file.size() ? file.size() - done + 1 : 0));
      std::size_t const got = file.read(done, text.data() + done, text.size() - done);
      bool const ended = done + got < text.size();
      text.resize(done + got);
      if (ended) return text;
    }
  } catch (std::bad_alloc const&) {
    throw DataError(ErrorCode::memory, path, "does not fit into memory (" + mebibytes(file.size()) + " of text)");
  }
}

LineReader::LineReader(std::string const& path, std::string const& wanted) : file_(path, wanted) {
  char first[2] = {'x', 'x'};
  file_.read(0, first, sizeof first);
  std::string_view const mark(first, sizeof first);
  if (mark != "\xff\xfe" && mark != "\xfe\xff" && mark.find('\0') == std::string_view::npos) return;
  std::string const text = decoded_text(read_text_file(path, wanted), path);
  buffer_.assign(text.begin(), text.end());
  end_ = text.size();
  ended_ = true;
}

std::optional<std::string_view> LineReader::next() {
  std::size_t searched = begin_;
  while (true) {
    char const* const from = buffer_.data();
    auto const* const stop =
        searched < end_ ? static_cast<char const*>(std::memchr(from + searched, '\n', end_ - searched)) : nullptr;
    if (stop || (ended_ && begin_ < end_)) {
      std::size_t const size = (stop ? static_cast<std::size_t>(stop - from) : end_) - begin_;
      std::string_view line(from + begin_, size);
      begin_ += size + (stop ? 1 : 0);
      offset_ += size + (stop ? 1 : 0);
      ++number_;
      if (line.ends_with('\r')) line.remove_suffix(1);
      if (number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);  // UTF-8 byte order mark
      return line;
    }
    if (ended_) return std::nullopt;
    searched = end_ - begin_;
    if (searched > 0) std::memmove(buffer_.data(), from + begin_, searched);
    begin_ = 0;
    end_ = searched;
    if (end_ > most_line_bytes) {
      throw DataError(
          ErrorCode::out_of_range, file_.path() + ':' + std::to_string(number_ + 1),
          "is longer than " + mebibytes(most_line_bytes) + ", too long for a line of a table; check the file");
    }
    buffer_.resize(std::max<std::size_t>(2 * end_, std::size_t{64} << 10));
    std::size_t const got = file_.read(offset_ + end_, buffer_.data() + end_, buffer_.size() - end_);
    ended_ = got < buffer_.size() - end_;
    end_ += got;
  }
}

std::string LineReader::place() const { return file_.path() + ':' + std::to_string(number_); }

}  // namespace gladstone::inline files
