#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/input_file.h"

namespace gladstone {

/// Most bytes of a setup or a study: lists of a million values fit.
inline constexpr std::uint64_t most_setup_bytes = std::uint64_t{32} << 20;

/// A whole file as it is.
/// @param wanted what to name instead of a folder or a pipe
/// @throws DataError where InputFile refuses it, it is longer than `most_bytes` or does not fit into memory
std::string read_text_file(std::string const& path, std::string const& wanted = "a file of text",
                           std::uint64_t most_bytes = std::uint64_t{4} << 30);

/// The lines of a table or a header in turn, without their ends ("\n" or "\r\n") and without UTF-8's byte-order mark.
class LineReader {
 public:
  /// @throws DataError as InputFile
  explicit LineReader(std::string const& path, std::string const& wanted = "a file of text");

  /// The next line, which stays until the next call; nothing at the file's end.
  /// @throws DataError at file:line for a line that no table of text has; Interrupted
  std::optional<std::string_view> next();
  /// Of the line that next() gave last, from 1.
  std::size_t number() const { return number_; }
  /// "file:number" of that line.
  std::string place() const;
  /// Of the first byte behind that line.
  std::uint64_t offset() const { return offset_; }

 private:
  InputFile file_;
  std::vector<char> buffer_;  ///< bytes [begin_, end_) are read and not given yet
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t offset_ = 0;  ///< of buffer_[begin_] in the file
  std::size_t number_ = 0;
  bool ended_ = false;
};

/// Most rows of a table: of points, rays or vectors.
inline constexpr std::size_t most_table_rows = 100'000'000;

/// Refuses one row more of a table than most_table_rows, or than there is memory for once its list is to grow.
/// @param what the rows are, "dots"
template <class Row>
void require_room(std::vector<Row> const& rows, std::string const& path, std::string const& what) {
  if (rows.size() < rows.capacity()) return;
  if (rows.size() >= most_table_rows) {
    throw DataError(path, "holds more than " + std::to_string(most_table_rows) + ' ' + what + "; take fewer");
  }
  // a list that doubles as it grows holds three times its size for a moment
  require_memory(path, "a table of more than " + std::to_string(rows.size()) + ' ' + what,
                 3.0 * static_cast<double>(rows.size() * sizeof(Row)));
}

/// Text as it is shown in a message: cut where it is long, with "..." then.
std::string excerpt(std::string_view text, std::size_t longest = 60);

}  // namespace gladstone
