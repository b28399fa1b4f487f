#pragma once

namespace gladstone::test {

/// True in a build with AddressSanitizer, which retains freed memory for a while. Resident memory is then no measure of
/// leaks, which the sanitizer finds itself.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool address_sanitizer = true;
#elif defined(__has_feature)
inline constexpr bool address_sanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool address_sanitizer = false;
#endif

}  // namespace gladstone::test
