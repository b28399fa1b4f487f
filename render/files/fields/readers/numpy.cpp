#include "render/files/fields/readers/numpy.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/fields/readers/listed_arrays.h"
#include "render/files/fields/readers/numpy_header.h"
#include "render/files/fields/readers/zip_archive.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Describes the content of an array that holds no real numbers, by its dtype.
std::string describe_dtype(std::string const& dtype) {
  char const kind = dtype.size() > 1 ? dtype[1] : ' ';
  if (dtype.starts_with('[') || kind == 'V') return "records (a structured dtype)";
  if (kind == 'O') return "Python objects (dtype object)";
  if (kind == 'c') return "complex numbers";
  if (kind == 'S' || kind == 'U' || kind == 'a') return "text";
  if (kind == 'M' || kind == 'm') return "dates or durations";
  return fmt::format("numbers of dtype \"{}\"", excerpt(dtype));
}

/// Reads values of an array in C order from the file.
void read_stored(ByteRange const& range, NpyHeader const& header, std::size_t first, std::span<double> out) {
  std::size_t const width = header.type->bytes;
  std::vector<char> bytes(std::min<std::size_t>(out.size(), 1 << 18) * width);
  for (std::size_t done = 0; done < out.size();) {
    std::size_t const count = std::min(out.size() - done, bytes.size() / width);
    std::size_t const got =
        range.file->read(range.offset + header.data + (first + done) * width, bytes.data(), count * width);
    if (got < count * width) refuse_truncated(range, got, count * width);
    for (std::size_t i = 0; i < count; ++i) out[done + i] = header.type->read(bytes.data() + i * width, header.swap);
    done += count;
  }
}

/// Iterates over an array in Fortran order, and returns the index in C order of each value.
class FortranOrder {
 public:
  explicit FortranOrder(std::vector<std::size_t> const& shape)
      : shape_(shape), index_(shape.size()), strides_(shape.size()) {
    for (std::size_t axis = shape.size(), stride = 1; axis-- > 0; stride *= shape[axis]) strides_[axis] = stride;
  }
  std::size_t next() {
    std::size_t const place = place_;
    for (std::size_t axis = 0; axis < shape_.size(); ++axis) {
      place_ += strides_[axis];
      if (++index_[axis] < shape_[axis]) break;
      place_ -= strides_[axis] * shape_[axis];
      index_[axis] = 0;
    }
    return place;
  }

 private:
  std::vector<std::size_t> const& shape_;
  std::vector<std::size_t> index_, strides_;
  std::size_t place_ = 0;
};

[[noreturn]] void refuse_checksum(ByteRange const& range) {
  throw DataError(ErrorCode::damaged, range.file->path(),
                  fmt::format("array \"{}\" is damaged (wrong checksum); copy it again", excerpt(range.name)));
}

/// Loads all values of an array that is compressed or in Fortran order.
/// @param crc  checksum of all bytes of the array's file
ValueStore load_npy(ByteRange const& range, NpyHeader const& header, std::optional<std::uint32_t> crc) {
  std::size_t const size = checked_bytes(header.shape, header.type->bytes, range.file->path(), range.name);
  std::vector<char> const bytes = read_up_to(range, header.data + size);
  if (bytes.size() < header.data + size) refuse_truncated(range, bytes.size() - header.data, size);
  if (crc && crc32_z(0, reinterpret_cast<unsigned char const*>(bytes.data()), bytes.size()) != *crc)
    refuse_checksum(range);
  std::size_t const count = size / header.type->bytes;
  ValueStore values;
  values.allocate(count, header.type->significant_bits, range.file->path(), "array \"" + excerpt(range.name) + '"');
  FortranOrder order(header.shape);
  for (std::size_t i = 0; i < count; ++i) {
    char const* const value = bytes.data() + header.data + i * header.type->bytes;
    values.set(header.fortran ? order.next() : i, header.type->read(value, header.swap));
  }
  return values;
}

/// Compares the checksum of the bytes of an uncompressed array with that of the archive.
void verify_stored(ByteRange const& range, std::uint32_t crc) {
  std::vector<unsigned char> bytes(1 << 20);
  uLong found = 0;
  for (std::uint64_t done = 0; done < range.size;) {
    throw_if_interrupted();
    std::size_t const wanted = std::min<std::uint64_t>(bytes.size(), range.size - done);
    std::size_t const got = range.file->read(range.offset + done, bytes.data(), wanted);
    if (got == 0) refuse_truncated(range, done, range.size);
    found = crc32_z(found, bytes.data(), got);
    done += got;
  }
  if (found != crc) refuse_checksum(range);
}

/// Checks the size of an array's data, and returns the array.
/// @param size  number of decompressed bytes of header and data
/// @param crc   checksum of these bytes, verified before the first value is read; nullopt: the file has none
ListedArray npy_array(ByteRange const& range, NpyHeader const& header, std::uint64_t size,
                      std::optional<std::uint32_t> crc) {
  std::size_t const required = checked_bytes(header.shape, header.type->bytes, range.file->path(), range.name);
  size = std::min(size, most_bytes(range));  // the directory of a damaged archive can declare any size
  std::uint64_t const present = size > header.data ? size - header.data : 0;
  if (present < required) refuse_truncated(range, present, required);
  if (present > required) {
    throw DataError(
        ErrorCode::damaged, range.file->path(),
        fmt::format("array \"{}\" has {} bytes of data, but its header requires {}; save one array per file",
                    excerpt(range.name), present, required));
  }
  ListedArray array{range.name, header.shape, header.type->significant_bits, {}};
  bool const direct = range.coding == ByteRange::Coding::stored && !header.fortran;
  if (direct) {
    auto const verified = std::make_shared<bool>(!crc);
    array.read = [range, header, crc, verified](std::size_t first, std::span<double> out) {
      if (!*verified) verify_stored(range, *crc);
      *verified = true;
      read_stored(range, header, first, out);
    };
  } else {
    array.read = load_once([range, header, crc] { return load_npy(range, header, crc); });
  }
  return array;
}

}  // namespace

std::unique_ptr<CheckedSource> open_npy(std::string const& path, FieldSelection const& selection) {
  if (!selection.dataset.empty()) {
    throw DataError(ErrorCode::missing_content, path,
                    "contains a single unnamed array; remove dataset = \"" + selection.dataset + "\"");
  }
  auto const file = std::make_shared<InputFile const>(path, "a field file");
  ByteRange const range{file, "array", 0, file->size()};
  NpyHeader const header = read_npy_header(range);
  if (!header.type) {
    throw DataError(
        ErrorCode::wrong_type, path,
        "holds " + describe_dtype(header.dtype) + ", not real numbers; save an array of float64, float32 or integers");
  }
  return open_array_field(
      std::make_unique<ListedArrays>(path, std::vector{npy_array(range, header, file->size(), std::nullopt)}), path,
      selection);
}

std::unique_ptr<CheckedSource> open_npz(std::string const& path, FieldSelection const& selection) {
  auto const file = std::make_shared<InputFile const>(path, "a field file");
  std::vector<ListedArray> arrays;
  std::vector<OtherEntry> others;
  for (ZipEntry entry : zip_entries(file)) {
    std::string& name = entry.range.name;
    if (!name.ends_with(".npy")) continue;
    name.resize(name.size() - std::string_view(".npy").size());
    NpyHeader const header = read_npy_header(entry.range);
    if (!header.type) {
      others.push_back({name, describe_dtype(header.dtype)});
      continue;
    }
    arrays.push_back(npy_array(entry.range, header, entry.size, entry.crc32));
  }
  return open_array_field(std::make_unique<ListedArrays>(path, std::move(arrays), std::move(others)), path, selection);
}

}  // namespace gladstone::inline files
