#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/files/input_file.h"

namespace gladstone::inline files {

/// Part of a file that holds the bytes of one array, possibly compressed.
struct ByteRange {
  enum class Coding { stored, deflate, zlib };

  std::shared_ptr<InputFile const> file;
  std::string name;          ///< name of the array, for messages
  std::uint64_t offset = 0;  ///< offset of the first stored byte in the file
  std::uint64_t size = 0;    ///< number of stored bytes
  Coding coding = Coding::stored;
};

/// Returns the largest number of bytes that a range can decompress to.
std::uint64_t most_bytes(ByteRange const& range);

/// Reads and decompresses the first `count` bytes; fewer if the range ends before.
/// @throws DataError if the compressed data are damaged
std::vector<char> read_up_to(ByteRange const& range, std::uint64_t count);

/// Throws DataError that an array has fewer bytes of data than its header requires.
[[noreturn]] void refuse_truncated(ByteRange const& range, std::uint64_t present, std::uint64_t required);

}  // namespace gladstone::inline files
