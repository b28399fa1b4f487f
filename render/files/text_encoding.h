#pragma once

#include <string>
#include <string_view>

namespace gladstone::inline files {

/// Returns true if the bytes are well-formed UTF-8, as JSON and TOML require (RFC 3629: no surrogates, no overlong
/// forms).
bool is_utf8(std::string_view bytes);

/// Converts the bytes of a text file to UTF-8. They are taken as UTF-16 if they begin with its byte order mark, as
/// UTF-8 if well-formed (a byte order mark is removed), else as ISO-8859-1. Line ends become "\n".
/// @param name  file name for messages
/// @throws DataError for malformed or truncated UTF-16, and for text with NUL characters
std::string decoded_text(std::string_view bytes, std::string const& name);

}  // namespace gladstone::inline files
