#pragma once

#include <string>
#include <string_view>

namespace gladstone {

/// Whether bytes are well-formed UTF-8 (RFC 3629: no surrogates, no longer forms than needed): JSON and TOML hold no
/// other.
bool is_utf8(std::string_view bytes);

/// The bytes of a text file as UTF-8, whatever they were: UTF-16 with a byte order mark, UTF-8 with or without one,
/// else ISO-8859-1. Line ends become "\n".
/// @param name of the file, for messages. @throws DataError for UTF-16 that is broken or cut short, and for text that
/// holds NUL characters, which no text does
std::string decoded_text(std::string_view bytes, std::string const& name);

}  // namespace gladstone
