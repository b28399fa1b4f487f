#include "render/files/content_hash.h"
#include "studies/sweep/results.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// The result of a case as it stands, and once more behind the hash that it should have, so that what follows is read.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  fuzz::read(input, [&] { parse_result(std::string(input), "cases/0.json"); });
  std::string const whole = "{\"hash\":\"" + content_hash(input) + "\"," + std::string(input);
  for (ResultPart const part : {ResultPart::head, ResultPart::all}) {
    fuzz::read(input, [&] { parse_result(whole, "cases/0.json", part); });
  }
  return 0;
}
