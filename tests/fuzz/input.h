#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

/// What a target defines, as libFuzzer calls it: one input given to one reader. A reader may refuse it as the user's
/// mistake; whatever else happens (a crash, a sanitizer's report, another exception, a hang, memory out of proportion)
/// fails the target.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

namespace gladstone::fuzz {

inline std::string_view text_of(std::uint8_t const* data, std::size_t size) {
  return {reinterpret_cast<char const*>(data), size};
}

/// Calls a reader; SetupError and DataError are answers too. Aborts where their text is a library's rather than ours:
/// "std::", "basic_", "[json.exception", "filesystem error". What stands in the input may be quoted.
void read(std::string_view input, std::function<void()> const& reader);

/// Writes a file into a folder that goes when the program ends. @return its path
std::string file_of(std::string_view content, std::string const& name);

}  // namespace gladstone::fuzz
