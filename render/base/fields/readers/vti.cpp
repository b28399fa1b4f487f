#include "render/base/fields/readers/vti.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <string_view>

#include "render/base/error.h"
#include "render/base/fields/readers/checked_source.h"
#include "render/base/fields/readers/vti_header.h"
#include "render/base/input_file.h"
#include "render/base/text_file.h"

namespace gladstone {
namespace {

struct NumberType {
  std::string_view name;
  std::size_t bytes;
  int significant_bits;
  double (*read)(char const* bytes, bool swap);
};

template <class Stored>
double read_number(char const* bytes, bool swap) {
  std::array<char, sizeof(Stored)> value;
  std::copy_n(bytes, sizeof(Stored), value.data());
  if (swap) std::reverse(value.begin(), value.end());
  return static_cast<double>(std::bit_cast<Stored>(value));
}

template <class Stored>
constexpr NumberType number_type(std::string_view name) {
  return {name, sizeof(Stored), std::numeric_limits<Stored>::digits, read_number<Stored>};
}

constexpr std::array number_types{
    number_type<float>("Float32"),        number_type<double>("Float64"),       number_type<std::int8_t>("Int8"),
    number_type<std::uint8_t>("UInt8"),   number_type<std::int16_t>("Int16"),   number_type<std::uint16_t>("UInt16"),
    number_type<std::int32_t>("Int32"),   number_type<std::uint32_t>("UInt32"), number_type<std::int64_t>("Int64"),
    number_type<std::uint64_t>("UInt64"),
};

/// Bytes in a file, as they are or as base64, of which each part that was written at once stands alone.
class StoredBytes {
 public:
  StoredBytes(InputFile const& file, VtiHeader const& header) : file_(file), header_(header), at_(header.begin) {}

  /// The next part of so many bytes. @throws DataError where the file ends before
  std::vector<char> next(std::uint64_t size) {
    bool const base64 = header_.format == VtiFormat::base64;
    std::uint64_t const stored = base64 ? (size + 2) / 3 * 4 : size;
    if (stored > file_.size() - std::min(file_.size(), at_)) {
      throw DataError(file_.path(), fmt::format("is cut short: data array \"{}\" ends beyond the file; copy it again",
                                                excerpt(header_.name)));
    }
    require_memory(file_.path(), "data array \"" + excerpt(header_.name) + '"', 2.0 * static_cast<double>(stored));
    std::vector<char> bytes(stored);
    bytes.resize(file_.read(at_, bytes.data(), bytes.size()));
    at_ += stored;
    return base64 ? decoded(bytes, size) : bytes;
  }
  /// One of the whole numbers that tell how long data are.
  std::uint64_t length(std::vector<char> const& bytes, std::size_t index) const {
    bool const swap = header_.big_endian != (std::endian::native == std::endian::big);
    char const* const at = bytes.data() + index * header_.size_bytes;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < header_.size_bytes; ++i) {
      std::size_t const place = swap ? header_.size_bytes - 1 - i : i;
      value |= std::uint64_t{static_cast<unsigned char>(at[place])} << (8 * i);
    }
    return value;
  }
  std::uint64_t place() const { return at_; }
  void go_to(std::uint64_t place) { at_ = place; }

 private:
  std::vector<char> decoded(std::vector<char> const& text, std::uint64_t size) const {
    static constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::uint32_t, 256> value{};
    value.fill(64);
    for (std::size_t i = 0; i < alphabet.size(); ++i)
      value[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint32_t>(i);
    value['='] = 0;
    std::vector<char> bytes(text.size() / 4 * 3);
    for (std::size_t i = 0; 4 * i + 3 < text.size(); ++i) {
      std::uint32_t group = 0, worst = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        std::uint32_t const six = value[static_cast<unsigned char>(text[4 * i + k])];
        worst = std::max(worst, six);
        group = group << 6 | (six & 63);
      }
      if (worst == 64) throw DataError(file_.path(), "is damaged: its base64 holds other characters; copy it again");
      for (std::size_t k = 0; k < 3; ++k) bytes[3 * i + k] = static_cast<char>(group >> (16 - 8 * k));
    }
    bytes.resize(std::min<std::size_t>(bytes.size(), size));
    return bytes;
  }

  InputFile const& file_;
  VtiHeader const& header_;
  std::uint64_t at_;
};

class VtiSource final : public CheckedSource {
 public:
  VtiSource(InputFile file, VtiHeader header, int values)
      : CheckedSource(file.path(), header.name, values), file_(std::move(file)), header_(std::move(header)) {
    auto const* const type = std::find_if(number_types.begin(), number_types.end(),
                                          [this](NumberType const& one) { return one.name == header_.type; });
    if (type == number_types.end()) {
      throw DataError(path_, fmt::format("data array \"{}\" is of type \"{}\", which is no number", excerpt(name_),
                                         excerpt(header_.type)));
    }
    type_ = *type;
    grid_.nodes = header_.nodes;
    grid_.spacing = header_.spacing;
    grid_.origin = header_.origin;
    units_.spaced = true;
  }

 private:
  int significant_bits() const override { return type_.significant_bits; }

  void read_raw_planes(int first_plane, int count, std::span<double> out) override {
    std::size_t const plane = row_values() * static_cast<std::size_t>(grid_.nodes[1]);
    give(plane * static_cast<std::size_t>(first_plane), plane * static_cast<std::size_t>(count), out);
  }
  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    std::size_t const rows = static_cast<std::size_t>(plane) * static_cast<std::size_t>(grid_.nodes[1]);
    give(row_values() * (rows + static_cast<std::size_t>(first_row)), row_values() * static_cast<std::size_t>(count),
         out);
  }

  void give(std::size_t first, std::size_t count, std::span<double> out) {
    if (bytes_.empty()) load();
    bool const text = header_.format == VtiFormat::ascii;
    bool const swap = !text && header_.big_endian != (std::endian::native == std::endian::big);
    std::size_t const size = text ? sizeof(double) : type_.bytes;
    for (std::size_t i = 0; i < count; ++i) {
      char const* const at = bytes_.data() + (first + i) * size;
      out[i] = text ? read_number<double>(at, false) : type_.read(at, swap);
    }
  }

  std::size_t all_values() const { return grid_.size() * static_cast<std::size_t>(values()); }

  void load() {
    if (header_.format == VtiFormat::ascii) return load_text();
    StoredBytes stored(file_, header_);
    std::uint64_t const needed = all_values() * type_.bytes;
    if (header_.compressed) {
      inflate(stored, needed);
    } else {
      bytes_ = stored.next(header_.size_bytes + needed);
      check_length(stored.length(bytes_, 0), needed);
      bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(header_.size_bytes));
    }
  }

  /// Blocks of zlib's: how many, bytes of each and of the last before compression, then of each behind it.
  void inflate(StoredBytes& stored, std::uint64_t needed) {
    std::uint64_t const begin = stored.place();
    std::uint64_t const blocks = stored.length(stored.next(3 * header_.size_bytes), 0);
    if (blocks > needed) check_length(blocks, needed);
    stored.go_to(begin);
    std::vector<char> const sizes = stored.next((3 + blocks) * header_.size_bytes);
    std::uint64_t const block = stored.length(sizes, 1), partial = stored.length(sizes, 2);
    double const whole =
        static_cast<double>(blocks > 0 && partial > 0 ? blocks - 1 : blocks) * static_cast<double>(block);
    check_length(whole + static_cast<double>(partial) > 9e18 ? 0 : static_cast<std::uint64_t>(whole) + partial, needed);
    std::uint64_t all = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      std::uint64_t const size = stored.length(sizes, 3 + i);
      if (size > file_.size()) check_length(size, needed);
      all += size;
    }
    std::vector<char> const packed = stored.next(all);
    require_memory(path_, "data array \"" + excerpt(name_) + '"', static_cast<double>(needed));
    bytes_.resize(needed);
    std::uint64_t from = 0, to = 0;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      std::uint64_t const size = stored.length(sizes, 3 + i);
      uLongf room = std::min(block, needed - to);
      int const result = uncompress(reinterpret_cast<Bytef*>(bytes_.data() + to), &room,
                                    reinterpret_cast<Bytef const*>(packed.data() + from), size);
      if (result != Z_OK) damaged("zlib cannot inflate it");
      from += size;
      to += room;
    }
    if (to != needed) damaged("it is shorter than its header says");
  }

  void load_text() {
    std::size_t const size = header_.end - header_.begin;
    require_memory(path_, "data array \"" + excerpt(name_) + '"',
                   static_cast<double>(size + all_values() * sizeof(double)));
    std::string text(size, ' ');
    text.resize(file_.read(header_.begin, text.data(), size));
    if (all_values() > size) check_length(size, all_values());
    bytes_.resize(all_values() * sizeof(double));
    char const* at = text.data();
    char const* const end = at + text.size();
    for (std::size_t i = 0; i < all_values(); ++i) {
      while (at != end && std::string_view(" \t\r\n").find(*at) != std::string_view::npos) ++at;
      double value = 0;
      auto const [rest, error] = std::from_chars(at, end, value);
      if (error != std::errc()) damaged(fmt::format("{} of {} numbers are there", i, all_values()));
      std::memcpy(bytes_.data() + i * sizeof(double), &value, sizeof value);
      at = rest;
    }
  }

  void check_length(std::uint64_t there, std::uint64_t needed) {
    if (there != needed) damaged(fmt::format("its length is {} where its grid needs {}", there, needed));
  }
  [[noreturn]] void damaged(std::string const& why) {
    bytes_.clear();
    throw DataError(path_, fmt::format("data array \"{}\" is damaged ({}); copy it again", excerpt(name_), why));
  }

  InputFile file_;
  VtiHeader header_;
  NumberType type_{};
  std::vector<char> bytes_;  ///< all values as stored; of a text as double
};

}  // namespace

std::unique_ptr<FieldSource> open_vti(std::string const& path, std::string const& dataset, int values) {
  InputFile file(path, "a field file");
  VtiHeader header = read_vti_header(file, dataset, values);
  return std::make_unique<VtiSource>(std::move(file), std::move(header), values);
}

}  // namespace gladstone
