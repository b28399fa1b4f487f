#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "render/files/fields/readers/byte_range.h"

namespace gladstone::inline files {

/// Entry of a zip archive.
struct ZipEntry {
  ByteRange range;
  std::uint64_t size = 0;   ///< number of decompressed bytes
  std::uint32_t crc32 = 0;  ///< CRC-32 of the decompressed bytes
};

/// Lists the entries of a zip archive, also one of more than 4 GiB (ZIP64); PKWARE, "APPNOTE.TXT", version 6.3.
/// @throws DataError for other files, truncated archives, and entries that are encrypted or neither stored nor deflated
std::vector<ZipEntry> zip_entries(std::shared_ptr<InputFile const> const& file);

}  // namespace gladstone::inline files
