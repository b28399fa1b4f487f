/// Writes what the setups of data/benchmarks/ read: `gladstone_bench_cases data/benchmarks`.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>

#include "render/base/units.h"
#include "render/files/output_file.h"
#include "tests/benchmarks/bench_scenes.h"

namespace gladstone::bench {
namespace {

/// n - 1 of volume_scene(nodes, ...) as NRRD: float, nothing but numbers behind the header.
std::string volume_text(int nodes) {
  double const cell = volume_width / (nodes - 1), first = -volume_width / 2;
  std::string text =
      fmt::format("NRRD0004\ntype: float\ndimension: 3\nsizes: {0} {0} {0}\nendian: little\nencoding: raw\n\n", nodes);
  for (int k = 0; k < nodes; ++k) {
    for (int j = 0; j < nodes; ++j) {
      for (int i = 0; i < nodes; ++i) {
        auto const value =
            static_cast<float>(smooth_refractivity({first + i * cell, first + j * cell, first + k * cell}, 1));
        text.append(reinterpret_cast<char const*>(&value), sizeof value);
      }
    }
  }
  return text;
}

/// The lattice of table1_scene(per_side, ...), to a millionth of a millimetre.
std::string dots_text(int per_side) {
  std::string text = "x_mm,y_mm\n";
  for (Vec2d const centre : table1_scene(per_side, 1).dots.centre)
    text += fmt::format("{:.6f},{:.6f}\n", centre.x / unit::millimetre, centre.y / unit::millimetre);
  return text;
}

}  // namespace
}  // namespace gladstone::bench

int main(int count, char** arguments) try {
  if (count != 2) {
    std::fputs("usage: gladstone_bench_cases FOLDER\n", stderr);
    return 2;
  }
  std::string const folder = arguments[1];
  gladstone::OutputFile::write_text(folder + "/case_p_volume.nrrd", gladstone::bench::volume_text(64));
  gladstone::OutputFile::write_text(folder + "/case_p_dots.csv", gladstone::bench::dots_text(85));
  return 0;
} catch (std::exception const& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
