#include "render/files/content_hash.h"
#include "studies/sweep/results.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// Reads the input as the result of a case: first unchanged, then with the correct hash in front, so that the contents
// are read, too.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  fuzz::read(input, [&] { parse_result(std::string(input), "cases/0.json"); });
  std::string const whole = "{\"hash\":\"" + content_hash(input) + "\"," + std::string(input);
  for (ResultPart const part : {ResultPart::head, ResultPart::all}) {
    fuzz::read(input, [&] { parse_result(whole, "cases/0.json", part); });
  }
  return 0;
}
