#include "render/files/fields/readers/matlab.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "render/base/error.h"
#include "render/files/fields/readers/byte_range.h"
#include "render/files/fields/readers/hdf5.h"
#include "render/files/fields/readers/listed_arrays.h"
#include "render/files/fields/readers/stored_number.h"
#include "render/files/hdf5_file.h"
#include "render/files/text_file.h"

namespace gladstone::inline files {
namespace {

/// Data type of the numbers of an element (MAT-File Format, table 1-1).
struct MatlabNumber : StoredNumber {
  std::uint32_t type;
};

template <class Stored>
constexpr MatlabNumber matlab_number(std::uint32_t type) {
  return {stored_number<Stored>(), type};
}

constexpr std::array matlab_numbers{matlab_number<std::int8_t>(1),   matlab_number<std::uint8_t>(2),
                                    matlab_number<std::int16_t>(3),  matlab_number<std::uint16_t>(4),
                                    matlab_number<std::int32_t>(5),  matlab_number<std::uint32_t>(6),
                                    matlab_number<float>(7),         matlab_number<double>(9),
                                    matlab_number<std::int64_t>(12), matlab_number<std::uint64_t>(13)};

constexpr std::uint32_t matrix_type = 14, compressed_type = 15;

/// Describes what an array of a class holds that is not numeric (table 1-3); empty for numbers.
std::string describe_class(std::uint32_t array_class, bool complex) {
  switch (array_class) {
    case 1:
      return "cells";
    case 2:
      return "a structure";
    case 3:
    case 17:
      return "objects";
    case 4:
      return "text";
    case 5:
      return "a sparse matrix";
    case 16:
      return "a function";
    default:
      return complex ? "complex numbers" : "";
  }
}

/// Element of a file: type, number of bytes and position of the data.
struct MatlabTag {
  std::uint32_t type = 0;
  std::uint64_t size = 0, data = 0, next = 0;
};

/// Reads the header of a matrix from its first bytes.
class MatrixHead {
 public:
  MatrixHead(ByteRange const& range, bool swap) : range_(range), swap_(swap), bytes_(read_up_to(range, 4096)) {}

  /// Reads the tag at a position. Up to four bytes of data may be stored in the tag itself, with their number in its
  /// upper half.
  MatlabTag tag(std::uint64_t at) const {
    std::uint32_t const first = word(at);
    if ((first >> 16) != 0) return {first & 0xFFFFu, first >> 16, at + 4, at + 8};
    std::uint32_t const size = word(at + 4);
    return {first, size, at + 8, at + 8 + (size + std::uint64_t{7}) / 8 * 8};
  }
  std::uint32_t word(std::uint64_t at) const {
    if (at + 4 > bytes_.size()) refuse();
    return static_cast<std::uint32_t>(read_number<std::uint32_t>(bytes_.data() + at, swap_));
  }
  std::string text(MatlabTag const& tag) const {
    if (tag.data + tag.size > bytes_.size()) refuse();
    return {bytes_.data() + tag.data, tag.size};
  }

  [[noreturn]] void refuse() const {
    throw DataError(ErrorCode::damaged, range_.file->path(),
                    "is cut short or damaged: the header of an array is incomplete; copy it again, or save it anew");
  }

 private:
  ByteRange const& range_;
  bool swap_;
  std::vector<char> bytes_;
};

/// Array of numbers in a file, with the location of its values.
struct MatlabArray {
  ByteRange range;
  std::vector<std::size_t> shape;  ///< slowest axis first
  MatlabNumber number{};
  std::uint64_t data = 0;  ///< offset of the first value in the decompressed range
  bool swap = false;
};

/// Converts values and calls set(index, value) for each.
template <class Set>
void convert_values(MatlabArray const& array, char const* bytes, std::size_t count, Set const& set) {
  for (std::size_t i = 0; i < count; ++i) set(i, array.number.read(bytes + i * array.number.bytes, array.swap));
}

void read_uncompressed(MatlabArray const& array, std::size_t first, std::span<double> out) {
  std::size_t const width = array.number.bytes;
  std::vector<char> bytes(out.size() * width);
  std::size_t const got =
      array.range.file->read(array.range.offset + array.data + first * width, bytes.data(), bytes.size());
  if (got < bytes.size()) refuse_truncated(array.range, got, bytes.size());
  convert_values(array, bytes.data(), out.size(), [&](std::size_t i, double value) { out[i] = value; });
}

ValueStore load_compressed(MatlabArray const& array) {
  std::string const& path = array.range.file->path();
  std::size_t const size = checked_bytes(array.shape, array.number.bytes, path, array.range.name);
  std::vector<char> const bytes = read_up_to(array.range, array.data + size);
  if (bytes.size() < array.data + size)
    refuse_truncated(array.range, bytes.size() - std::min<std::uint64_t>(bytes.size(), array.data), size);
  std::size_t const count = size / array.number.bytes;
  ValueStore values;
  values.allocate(count, array.number.significant_bits, path, "array \"" + excerpt(array.range.name) + '"');
  convert_values(array, bytes.data() + array.data, count, [&](std::size_t i, double value) { values.set(i, value); });
  return values;
}

/// Contents of a file of level 5.
class MatlabFile {
 public:
  MatlabFile(std::string const& path, std::string const& wanted)
      : file_(std::make_shared<InputFile const>(path, wanted)) {
    constexpr std::uint64_t header = 128;
    std::string order(2, '\0');
    if (file_->read(header - 2, order.data(), 2) < 2 || (order != "IM" && order != "MI")) cut_short();
    swap_ = (order == "IM") != (std::endian::native == std::endian::little);
    for (std::uint64_t at = header; at < file_->size();) {
      std::array<char, 8> tag{};
      if (file_->read(at, tag.data(), tag.size()) < tag.size()) cut_short();
      auto const type = static_cast<std::uint32_t>(read_number<std::uint32_t>(tag.data(), swap_));
      auto const size = static_cast<std::uint64_t>(read_number<std::uint32_t>(tag.data() + 4, swap_));
      bool const compressed = type == compressed_type;
      if (size > file_->size() - at - tag.size()) cut_short();
      if (compressed) add({file_, "", at + tag.size(), size, ByteRange::Coding::zlib});
      if (type == matrix_type) add({file_, "", at, size + tag.size(), ByteRange::Coding::stored});
      at += tag.size() + size;
    }
  }

  std::vector<ListedArray> arrays;
  std::vector<OtherEntry> others;

 private:
  /// Adds the matrix of a range that begins with its tag.
  void add(ByteRange range) {
    MatrixHead const head(range, swap_);
    MatlabTag const matrix = head.tag(0);
    if (matrix.type != matrix_type) return;
    if (matrix.size == 0) return;  // an empty matrix has no header
    MatlabTag const flags = head.tag(8), sizes = head.tag(flags.next), name = head.tag(sizes.next);
    range.name = head.text(name);
    if (range.name.empty()) return;  // arrays without a name hold internal data of MATLAB
    std::uint32_t const word = head.word(flags.data);
    constexpr std::uint32_t complex_bit = 0x0800;
    std::string const other = describe_class(word & 0xFFu, (word & complex_bit) != 0);
    if (!other.empty()) {
      others.push_back({range.name, other});
      return;
    }
    MatlabTag const values = head.tag(name.next);
    auto const* const number = std::find_if(matlab_numbers.begin(), matlab_numbers.end(),
                                            [&](MatlabNumber const& one) { return one.type == values.type; });
    if (number == matlab_numbers.end()) head.refuse();
    MatlabArray array{range, {}, *number, values.data, swap_};
    for (std::uint64_t at = sizes.data; at < sizes.data + sizes.size; at += 4)
      array.shape.insert(array.shape.begin(), head.word(at));
    std::uint64_t const required = checked_bytes(array.shape, number->bytes, file_->path(), range.name);
    if (values.size != required) refuse_truncated(range, values.size, required);
    std::uint64_t const most = most_bytes(range);
    if (values.data + required > most) refuse_truncated(range, most - std::min(most, values.data), required);
    ListedArray listed{range.name, array.shape, number->significant_bits, {}};
    listed.matlab_class = "double";
    if (range.coding == ByteRange::Coding::stored) {
      listed.read = [array](std::size_t first, std::span<double> out) { read_uncompressed(array, first, out); };
    } else {
      listed.read = load_once([array] { return load_compressed(array); });
    }
    arrays.push_back(std::move(listed));
  }

  [[noreturn]] void cut_short() const {
    throw DataError(ErrorCode::damaged, file_->path(), "is cut short: its last array is incomplete; copy it again");
  }

  std::shared_ptr<InputFile const> file_;
  bool swap_ = false;
};

/// Returns true for a file of version 7.3, false for one of level 5. @throws DataError for other files
bool is_version_7_3(std::string const& path, std::string const& wanted) {
  constexpr std::string_view level_5 = "MATLAB 5.0";
  std::string start(level_5.size(), '\0');
  start.resize(InputFile(path, wanted).read(0, start.data(), start.size()));
  if (start == "MATLAB 7.3" || start.starts_with("\x89HDF")) return true;
  if (start == level_5) return false;
  throw DataError(ErrorCode::wrong_format, path,
                  "is not a MATLAB file of level 5 or 7.3; save it with the option -v7 or -v7.3 of save");
}

}  // namespace

std::unique_ptr<CheckedSource> open_matlab(std::string const& path, FieldSelection const& selection) {
  if (is_version_7_3(path, "a field file")) return open_hdf5(path, selection);
  MatlabFile file(path, "a field file");
  return open_array_field(std::make_unique<ListedArrays>(path, std::move(file.arrays), std::move(file.others)), path,
                          selection);
}

std::vector<ListedArray> list_matlab_arrays(std::string const& path, std::string const& wanted) {
  if (!is_version_7_3(path, wanted)) return MatlabFile(path, wanted).arrays;
  auto const file = std::make_shared<Hdf5Reader>(path);
  std::vector<ListedArray> arrays;
  for (std::string const& dataset : file->number_datasets()) {
    ReadValues const read = [file, dataset](std::size_t first, std::span<double> out) {
      std::vector<double> const values = file->read(dataset);
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), out.size(), out.begin());
    };
    arrays.push_back({dataset.substr(1), file->shape(dataset), file->significant_bits(dataset), read});
  }
  return arrays;
}

}  // namespace gladstone::inline files
