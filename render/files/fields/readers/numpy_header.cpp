#include "render/files/fields/readers/numpy_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/text.h"

namespace gladstone::inline files {
namespace {

/// Converts a number of half precision (IEEE 754 binary16).
double read_half(char const* bytes, bool swap) {
  auto const bits = static_cast<unsigned>(read_number<std::uint16_t>(bytes, swap));
  int const exponent = static_cast<int>(bits >> 10 & 31);
  double const fraction = bits & 1023;
  double const size = exponent == 31  ? (fraction == 0 ? std::numeric_limits<double>::infinity()
                                                       : std::numeric_limits<double>::quiet_NaN())
                      : exponent == 0 ? std::ldexp(fraction, -24)
                                      : std::ldexp(1024 + fraction, exponent - 25);
  return (bits >> 15) != 0 ? -size : size;
}

template <class Stored>
constexpr NumpyType numpy_type(std::string_view code) {
  return {stored_number<Stored>(), code};
}

constexpr std::array numpy_types{
    NumpyType{{2, 11, read_half}, "f2"}, numpy_type<float>("f4"),         numpy_type<double>("f8"),
    numpy_type<std::int8_t>("i1"),       numpy_type<std::int16_t>("i2"),  numpy_type<std::int32_t>("i4"),
    numpy_type<std::int64_t>("i8"),      numpy_type<std::uint8_t>("u1"),  numpy_type<std::uint16_t>("u2"),
    numpy_type<std::uint32_t>("u4"),     numpy_type<std::uint64_t>("u8"), numpy_type<std::uint8_t>("b1"),
};

/// Parser of the dictionary in a header: {'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }.
class NpyDictionary {
 public:
  NpyDictionary(std::string text, ByteRange const& range) : text_(std::move(text)), range_(range) {}

  std::string dtype() const {
    std::string_view const value = after("descr");
    if (value.starts_with('[')) return "[";
    if (!value.starts_with('\'') && !value.starts_with('"')) refuse();
    std::size_t const end = value.find(value.front(), 1);
    if (end == std::string_view::npos) refuse();
    return std::string(value.substr(1, end - 1));
  }

  bool fortran_order() const {
    std::string_view const value = after("fortran_order");
    if (!value.starts_with("True") && !value.starts_with("False")) refuse();
    return value.starts_with("True");
  }

  std::vector<std::size_t> shape() const {
    std::string_view value = after("shape");
    std::size_t const end = value.find(')');
    if (!value.starts_with('(') || end == std::string_view::npos) refuse();
    value = value.substr(1, end - 1);
    std::vector<std::size_t> sizes;
    constexpr std::size_t most_axes = 64;  // maximum of NumPy 2
    while ((value = value.substr(std::min(value.find_first_not_of(" ,L"), value.size()))), !value.empty()) {
      std::size_t size = 0;
      auto const [rest, error] = std::from_chars(value.data(), value.data() + value.size(), size);
      if (error != std::errc() || sizes.size() == most_axes) refuse();
      sizes.push_back(size);
      value.remove_prefix(static_cast<std::size_t>(rest - value.data()));
    }
    return sizes;
  }

 private:
  /// Returns the text that begins with the value of a key.
  std::string_view after(std::string const& key) const {
    for (char const quote : {'\'', '"'}) {
      std::size_t const at = text_.find(quote + key + quote);
      std::size_t const colon = at == std::string::npos ? at : text_.find(':', at + key.size() + 2);
      if (colon == std::string::npos) continue;
      std::string_view const value = std::string_view(text_).substr(colon + 1);
      return value.substr(std::min(value.find_first_not_of(" \t\n"), value.size()));
    }
    refuse();
  }

  [[noreturn]] void refuse() const {
    throw DataError(ErrorCode::damaged, range_.file->path(),
                    fmt::format("array \"{}\" has a damaged NumPy header \"{}\"; save it again", excerpt(range_.name),
                                excerpt(text_, 100)));
  }

  std::string text_;
  ByteRange const& range_;
};

}  // namespace

NpyHeader read_npy_header(ByteRange const& range) {
  constexpr std::size_t magic = 8, longest = std::size_t{1} << 20;
  std::vector<char> start = read_up_to(range, magic + 4);
  std::string_view const text(start.data(), start.size());
  if (!text.starts_with("\x93NUMPY")) {
    throw DataError(ErrorCode::wrong_format, range.file->path(),
                    fmt::format("array \"{}\" is not in NumPy's format (no magic string); save it by numpy.save",
                                excerpt(range.name)));
  }
  if (start.size() < magic + 4) refuse_truncated(range, start.size(), magic + 4);
  int const version = static_cast<unsigned char>(start[6]);
  if (version < 1 || version > 3) {
    throw DataError(ErrorCode::unsupported, range.file->path(),
                    fmt::format("array \"{}\" is of NumPy format {} (1 to 3 are read); save it again",
                                excerpt(range.name), version));
  }
  std::size_t const length_bytes = version == 1 ? 2 : 4;
  std::uint64_t length = 0;
  for (std::size_t i = length_bytes; i-- > 0;) length = length << 8 | static_cast<unsigned char>(start[magic + i]);
  NpyHeader header;
  header.data = magic + length_bytes + length;
  if (length > longest) {
    throw DataError(
        ErrorCode::damaged, range.file->path(),
        fmt::format("array \"{}\" has an implausible header of {} bytes; it is damaged", excerpt(range.name), length));
  }
  start = read_up_to(range, header.data);
  if (start.size() < header.data) refuse_truncated(range, start.size(), header.data);
  NpyDictionary const entries(
      std::string(start.begin() + static_cast<std::ptrdiff_t>(magic + length_bytes), start.end()), range);
  header.dtype = entries.dtype();
  header.fortran = entries.fortran_order();
  header.shape = entries.shape();
  std::string const code = header.dtype.empty() ? "" : header.dtype.substr(1);
  for (NumpyType const& type : numpy_types) {
    if (type.code == code) header.type = type;
  }
  char const order = header.dtype.empty() ? ' ' : header.dtype.front();
  if (std::string_view("<>|=").find(order) == std::string_view::npos) header.type.reset();
  header.swap = (order == '>' && std::endian::native == std::endian::little) ||
                (order == '<' && std::endian::native == std::endian::big);
  return header;
}

}  // namespace gladstone::inline files
