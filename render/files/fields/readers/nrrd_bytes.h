#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/files/fields/readers/nrrd_header.h"
#include "render/files/input_file.h"

struct gzFile_s;  // of zlib

namespace gladstone::inline files {

/// Random access to the bytes of the data section: raw data by pread, gzip data by zlib; other encodings are decoded
/// into memory at the first access, text as doubles.
class NrrdBytes {
 public:
  /// @param header  must outlive this object
  /// @throws DataError if the data are shorter or longer than the header says, or not gzip data as declared
  explicit NrrdBytes(NrrdHeader const& header);
  ~NrrdBytes() { close(); }
  NrrdBytes(NrrdBytes const&) = delete;
  NrrdBytes& operator=(NrrdBytes const&) = delete;

  /// Reads bytes [first, first + size) of the decoded field.
  /// @throws DataError for data that are damaged or cut short
  void read(std::size_t first, void* out, std::size_t size);

 private:
  void close();

  void skip_lines();

  /// Finds the offset of raw data and checks their length.
  void prepare_raw();

  /// Returns true if a part of the file contains only line ends, as added by an editor.
  bool only_line_ends(std::size_t offset, std::size_t size) const;

  /// Returns the encoded data section, without the bytes to be skipped (bzip2: skipped after decompression).
  std::string stored() const;

  /// Opens the gzip stream and moves to the first value.
  void prepare_gzip();

  void inflate(char* out, std::size_t size);

  void discard(std::size_t size);

  /// Reads past the last value, which makes zlib verify its checksum, and checks that no further data follow.
  void check_end();

  [[noreturn]] void damaged() const;

  NrrdHeader const& header_;
  InputFile file_;
  gzFile_s* stream_ = nullptr;
  std::size_t offset_ = 0;     ///< offset of the first value in the stored file [bytes]
  std::size_t skipped_ = 0;    ///< decompressed bytes before the first value
  std::size_t position_ = 0;   ///< position of the gzip stream after the first value [decompressed bytes]
  std::vector<char> decoded_;  ///< all decoded bytes, for encodings held in memory
};

}  // namespace gladstone::inline files
