#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

/// Function that every target defines and libFuzzer calls: passes one input to one reader. The reader may reject the
/// input with SetupError or DataError; a crash, a sanitizer's report, another exception, a hang or excessive memory is
/// a failure.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

namespace gladstone::fuzz {

inline std::string_view text_of(std::uint8_t const* data, std::size_t size) {
  return {reinterpret_cast<char const*>(data), size};
}

/// Calls a reader, which may throw SetupError or DataError. Aborts if the message is that of a library ("std::",
/// "basic_", "[json.exception", "filesystem error"), unless the input contains this text.
void read(std::string_view input, std::function<void()> const& reader);

/// Writes a file into a folder that is removed when the program ends.
/// @return its path
std::string file_of(std::string_view content, std::string const& name);

}  // namespace gladstone::fuzz
