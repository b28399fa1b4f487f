#pragma once

#include <string>
#include <string_view>

namespace gladstone::inline files {

/// Encodes bytes in Base64 with padding (RFC 4648, section 4).
std::string base64(std::string_view bytes);

}  // namespace gladstone::inline files
