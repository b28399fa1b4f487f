#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/input_file.h"

namespace gladstone::inline files {

/// Maximum size of a setup or study file [bytes]; enough for lists of a million values.
inline constexpr std::uint64_t most_setup_bytes = std::uint64_t{32} << 20;

/// Reads a whole file.
/// @param wanted  kind of file expected, for the message if the path is a directory or a pipe
/// @throws DataError if InputFile refuses it, if it is longer than `most_bytes` or does not fit into memory
std::string read_text_file(std::string const& path, std::string const& wanted = "a file of text",
                           std::uint64_t most_bytes = std::uint64_t{4} << 30);

/// Reads a text file line by line, without line ends ("\n" or "\r\n") and without the UTF-8 byte order mark. A file
/// that begins with the byte order mark of UTF-16 is read at once and converted to UTF-8, see decoded_text().
class LineReader {
 public:
  /// @throws DataError as InputFile, and for malformed UTF-16 or UTF-16 without byte order mark
  explicit LineReader(std::string const& path, std::string const& wanted = "a file of text");

  /// Returns the next line, valid until the next call; nullopt at the end of the file.
  /// @throws DataError "file:line" for a line longer than 1 MiB; Interrupted
  std::optional<std::string_view> next();
  /// Number of the line that next() returned last, counted from 1.
  std::size_t number() const { return number_; }
  /// Location of the line that next() returned last, "file:number".
  std::string place() const;
  /// Offset in the file of the first byte after the line that next() returned last; meaningless for UTF-16.
  std::uint64_t offset() const { return offset_; }

 private:
  InputFile file_;
  std::vector<char> buffer_;  ///< read buffer; bytes [begin_, end_) have not been returned yet
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t offset_ = 0;  ///< offset of buffer_[begin_] in the file
  std::size_t number_ = 0;
  bool ended_ = false;
};

/// Maximum number of rows of a table of points, rays or vectors.
inline constexpr std::size_t most_table_rows = 100'000'000;

/// Throws if another row would exceed most_table_rows or, when the vector must grow, the available memory.
/// @param what  name of the rows for the message, "dots"
/// @throws DataError
template <class Row>
void require_room(std::vector<Row> const& rows, std::string const& path, std::string const& what) {
  if (rows.size() < rows.capacity()) return;
  if (rows.size() >= most_table_rows) {
    throw DataError(ErrorCode::out_of_range, path,
                    "holds more than " + std::to_string(most_table_rows) + ' ' + what + "; reduce their number");
  }
  // While a vector doubles its capacity, the old and the new storage take three times its size.
  require_memory(path, "a table of more than " + std::to_string(rows.size()) + ' ' + what,
                 3.0 * static_cast<double>(rows.size() * sizeof(Row)));
}

}  // namespace gladstone::inline files
