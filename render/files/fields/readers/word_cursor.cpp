#include "render/files/fields/readers/word_cursor.h"

#include <cctype>

#include "render/base/error.h"
#include "render/base/interrupt.h"

namespace gladstone::inline files {

void WordCursor::go_to(std::uint64_t place) {
  begin_ = place;
  at_ = 0;
  buffer_.clear();
}

int WordCursor::peek() {
  if (at_ == buffer_.size()) {
    throw_if_interrupted();
    begin_ += buffer_.size();
    at_ = 0;
    buffer_.resize(std::size_t{1} << 16);
    buffer_.resize(file_.read(begin_, buffer_.data(), buffer_.size()));
    if (buffer_.empty()) return -1;
  }
  return static_cast<unsigned char>(buffer_[at_]);
}

int WordCursor::take() {
  int const c = peek();
  if (c >= 0) ++at_;
  return c;
}

std::string WordCursor::word() {
  while (peek() >= 0 && std::isspace(peek()) != 0) take();
  std::string text;
  constexpr std::size_t most = 4096;
  while (peek() >= 0 && std::isspace(peek()) == 0) {
    text += static_cast<char>(take());
    if (text.size() > most)
      throw DataError(ErrorCode::damaged, file_.path(),
                      "is damaged: it contains a word that is too long for a legacy VTK file; copy it again");
  }
  return text;
}

std::string WordCursor::line() {
  std::string text;
  constexpr std::size_t most = 65536;
  for (int c = take(); c >= 0 && c != '\n'; c = take()) {
    text += static_cast<char>(c);
    if (text.size() > most)
      throw DataError(ErrorCode::damaged, file_.path(),
                      "is damaged: it contains a line that is too long for a legacy VTK file; copy it again");
  }
  if (!text.empty() && text.back() == '\r') text.pop_back();
  return text;
}

}  // namespace gladstone::inline files
