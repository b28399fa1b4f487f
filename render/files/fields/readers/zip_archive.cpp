#include "render/files/fields/readers/zip_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

using namespace std::string_view_literals;

/// Little-endian integers in a part of an archive.
class ZipFields {
 public:
  ZipFields(InputFile const& file, std::uint64_t offset, std::uint64_t size) : file_(file) {
    require_memory(file.path(), "the directory of the archive", static_cast<double>(size));
    bytes_.resize(size);
    if (offset > file.size() || file.read(offset, bytes_.data(), size) < size) refuse();
  }

  std::uint64_t number(std::size_t at, std::size_t bytes) const {
    if (at + bytes > bytes_.size()) refuse();
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return value;
  }
  std::string text(std::size_t at, std::size_t size) const {
    if (at + size > bytes_.size()) refuse();
    return bytes_.substr(at, size);
  }
  bool has(std::string_view signature, std::size_t at) const {
    return at + signature.size() <= bytes_.size() && bytes_.compare(at, signature.size(), signature) == 0;
  }
  std::string const& bytes() const { return bytes_; }

  [[noreturn]] void refuse() const {
    throw DataError(ErrorCode::damaged, file_.path(),
                    "is cut short or damaged: the directory of its archive is incomplete; copy it again");
  }

 private:
  InputFile const& file_;
  std::string bytes_;
};

struct ZipDirectory {
  std::uint64_t entries = 0, size = 0, offset = 0;
};

/// Finds the directory by the records at the end of the archive: the usual one, and that of ZIP64 before it.
ZipDirectory find_directory(InputFile const& file) {
  constexpr std::uint64_t record = 22, longest_comment = 65535, locator = 20;
  std::uint64_t const size = std::min(file.size(), record + longest_comment + locator);
  ZipFields const end(file, file.size() - size, size);
  std::size_t const at = end.bytes().rfind("PK\x05\x06"sv);
  if (at == std::string::npos) end.refuse();
  ZipDirectory directory{end.number(at + 10, 2), end.number(at + 12, 4), end.number(at + 16, 4)};
  if (at >= locator && end.has("PK\x06\x07"sv, at - locator)) {
    ZipFields const large(file, end.number(at - locator + 8, 8), 56);
    if (!large.has("PK\x06\x06"sv, 0)) end.refuse();
    directory = {large.number(32, 8), large.number(40, 8), large.number(48, 8)};
  }
  if (directory.size > file.size() || directory.offset > file.size() - directory.size) end.refuse();
  return directory;
}

/// Replaces values of 2^32 - 1 by those of the extra field of ZIP64.
/// @param values  decompressed size, compressed size and offset, in the order of the field
void read_large_values(ZipFields const& fields, std::size_t begin, std::size_t end,
                       std::initializer_list<std::uint64_t*> values) {
  for (std::size_t at = begin; at + 4 <= end; at += 4 + fields.number(at + 2, 2)) {
    if (fields.number(at, 2) != 1) continue;
    std::size_t from = at + 4;
    for (std::uint64_t* const value : values) {
      if (*value != 0xFFFFFFFFu) continue;
      *value = fields.number(from, 8);
      from += 8;
    }
    return;
  }
}

}  // namespace

std::vector<ZipEntry> zip_entries(std::shared_ptr<InputFile const> const& file) {
  std::string start(4, '\0');
  start.resize(file->read(0, start.data(), start.size()));
  if (!start.starts_with("PK\x03\x04") && !start.starts_with("PK\x05\x06"))
    throw DataError(ErrorCode::wrong_format, file->path(),
                    "is not a zip archive; copy it again, or name it by its format");
  ZipDirectory const directory = find_directory(*file);
  ZipFields const fields(*file, directory.offset, directory.size);
  std::vector<ZipEntry> entries;
  std::size_t at = 0;
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    if (!fields.has("PK\x01\x02"sv, at)) fields.refuse();
    std::uint64_t const flags = fields.number(at + 8, 2), method = fields.number(at + 10, 2);
    std::uint64_t stored = fields.number(at + 20, 4), size = fields.number(at + 24, 4);
    std::uint64_t const name = fields.number(at + 28, 2), extra = fields.number(at + 30, 2);
    std::uint64_t offset = fields.number(at + 42, 4);
    read_large_values(fields, at + 46 + name, at + 46 + name + extra, {&size, &stored, &offset});
    ZipEntry entry;
    entry.range = {file, fields.text(at + 46, name), 0, stored,
                   method == 0 ? ByteRange::Coding::stored : ByteRange::Coding::deflate};
    entry.size = size;
    entry.crc32 = static_cast<std::uint32_t>(fields.number(at + 16, 4));
    if ((flags & 1) != 0 || (method != 0 && method != 8)) {
      throw DataError(ErrorCode::unsupported, file->path(),
                      fmt::format("entry \"{}\" is {}, which is not supported; save the archive by numpy.savez",
                                  excerpt(entry.range.name),
                                  (flags & 1) != 0 ? "encrypted" : fmt::format("compressed by method {}", method)));
    }
    ZipFields const local(*file, offset, 30);
    if (!local.has("PK\x03\x04"sv, 0)) fields.refuse();
    entry.range.offset = offset + 30 + local.number(26, 2) + local.number(28, 2);
    if (stored > file->size() || entry.range.offset > file->size() - stored) fields.refuse();
    entries.push_back(std::move(entry));
    at += 46 + name + extra + fields.number(at + 32, 2);
  }
  return entries;
}

}  // namespace gladstone::inline files
