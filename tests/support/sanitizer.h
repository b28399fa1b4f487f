#pragma once

namespace gladstone::test {

/// True in a build with AddressSanitizer, which keeps freed memory for a while: resident memory then tells nothing of
/// leaks, for which the sanitizer has a search of its own.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool address_sanitizer = true;
#elif defined(__has_feature)
inline constexpr bool address_sanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool address_sanitizer = false;
#endif

}  // namespace gladstone::test
