#pragma once

#include <cstdint>
#include <string>

#include "render/files/input_file.h"

namespace gladstone::inline files {

/// Sequential reader of words, lines and bytes of a legacy VTK file.
class WordCursor {
 public:
  explicit WordCursor(InputFile const& file) : file_(file) {}

  /// Returns the offset in the file [bytes].
  std::uint64_t place() const { return begin_ + at_; }
  void go_to(std::uint64_t place);
  /// Returns the next byte; -1 at the end of the file.
  int peek();
  /// Returns the next byte and moves beyond it; -1 at the end of the file.
  int take();
  /// Returns the next word; empty at the end of the file. @throws DataError for a word longer than 4096 bytes
  std::string word();
  /// Returns the rest of the line without its end. @throws DataError for a line longer than 64 KiB
  std::string line();

 private:
  InputFile const& file_;
  std::uint64_t begin_ = 0;  ///< offset of the buffer in the file [bytes]
  std::string buffer_;
  std::size_t at_ = 0;  ///< offset of the next byte in the buffer
};

}  // namespace gladstone::inline files
