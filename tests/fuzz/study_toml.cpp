#include <algorithm>

#include "studies/sweep/study_file.h"
#include "tests/fuzz/input.h"

using namespace gladstone;

// A study file in a folder with an empty "base.toml"; the values of its axes are computed as in planning.
extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  std::string_view const input = fuzz::text_of(data, size);
  static std::string const base = fuzz::file_of("schema = 1\nexperiment = \"bos\"\n", "base.toml");
  std::string const path = fuzz::file_of(input, "study.toml");
  fuzz::read(input, [&] {
    StudyFile const study = read_study(path);
    for (AxisPlan const& axis : study.axes) {
      for (std::size_t i = 0; i < std::min<std::size_t>(axis.size(), 100); ++i) axis.value(i);
      axis.value_at(0.999);
    }
    study.points();
  });
  return 0;
}
