#include "render/files/text_encoding.h"

#include <cstdint>

#include "render/base/error.h"

namespace gladstone::inline files {
namespace {

void append_utf8(std::string& text, std::uint32_t point) {
  auto const put = [&text](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (point < 0x80) {
    put(point);
  } else if (point < 0x800) {
    put(0xc0 | point >> 6);
    put(0x80 | (point & 0x3f));
  } else if (point < 0x10000) {
    put(0xe0 | point >> 12);
    put(0x80 | (point >> 6 & 0x3f));
    put(0x80 | (point & 0x3f));
  } else {
    put(0xf0 | point >> 18);
    put(0x80 | (point >> 12 & 0x3f));
    put(0x80 | (point >> 6 & 0x3f));
    put(0x80 | (point & 0x3f));
  }
}

std::string from_utf16(std::string_view bytes, bool little, std::string const& name) {
  if (bytes.size() % 2 != 0)
    throw DataError(ErrorCode::damaged, name, "is cut short (UTF-16 text of an odd number of bytes)");
  auto const unit_at = [&](std::size_t i) {
    auto const low = static_cast<unsigned char>(bytes[i + (little ? 0 : 1)]);
    auto const high = static_cast<unsigned char>(bytes[i + (little ? 1 : 0)]);
    return static_cast<std::uint32_t>(high) << 8 | low;
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    std::uint32_t point = unit_at(i);
    if (point >= 0xd800 && point < 0xe000) {
      bool const pair = point < 0xdc00 && i + 2 < bytes.size() && unit_at(i + 2) >= 0xdc00 && unit_at(i + 2) < 0xe000;
      if (!pair) throw DataError(ErrorCode::wrong_format, name, "is not text (invalid UTF-16); save it again as UTF-8");
      point = 0x10000 + ((point - 0xd800) << 10) + (unit_at(i + 2) - 0xdc00);
      i += 2;
    }
    append_utf8(text, point);
  }
  return text;
}

std::string with_plain_line_ends(std::string const& text) {
  std::string plain;
  plain.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\r') {
      plain.push_back(text[i]);
    } else if (i + 1 >= text.size() || text[i + 1] != '\n') {
      plain.push_back('\n');
    }
  }
  return plain;
}

}  // namespace

bool is_utf8(std::string_view bytes) {
  auto const byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  for (std::size_t i = 0; i < bytes.size();) {
    unsigned char const first = byte(i);
    std::size_t const length = first < 0x80         ? 1
                               : first >> 5 == 0x6  ? 2
                               : first >> 4 == 0xe  ? 3
                               : first >> 3 == 0x1e ? 4
                                                    : 0;
    if (length == 0 || i + length > bytes.size()) return false;
    std::uint32_t point = length == 1 ? first : first & (0x7fu >> length);
    for (std::size_t k = 1; k < length; ++k) {
      if (byte(i + k) >> 6 != 0x2) return false;
      point = point << 6 | (byte(i + k) & 0x3fu);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (point < least[length] || point > 0x10ffff || (point >= 0xd800 && point < 0xe000)) return false;
    i += length;
  }
  return true;
}

std::string decoded_text(std::string_view bytes, std::string const& name) {
  std::string text;
  if (bytes.starts_with("\xff\xfe")) {
    text = from_utf16(bytes.substr(2), true, name);
  } else if (bytes.starts_with("\xfe\xff")) {
    text = from_utf16(bytes.substr(2), false, name);
  } else {
    if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
    if (is_utf8(bytes)) {
      text = bytes;
    } else {
      for (char const c : bytes) append_utf8(text, static_cast<unsigned char>(c));
    }
  }
  if (text.find('\0') != std::string::npos) {
    throw DataError(ErrorCode::wrong_format, name,
                    "is not text (it contains zero bytes); UTF-16 needs its byte order mark");
  }
  return with_plain_line_ends(text);
}

}  // namespace gladstone::inline files
