#include <cmath>
#include <sstream>

#include "tests/benchmarks/bench_scenes.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// The setups in data/benchmarks are the scenes of the benchmarks.
class BenchmarkSetups : public ProgramFixture {
 protected:
  static std::string path(std::string const& name) { return std::string(GLADSTONE_DATA_DIR) + "/benchmarks/" + name; }
  /// Renders one of them with few rays and the given changes, and returns its summary.
  nlohmann::json summary_of(std::string const& name, std::vector<std::string> const& changes) const {
    std::vector<std::string> more{"--device", "cpu", "--set", "render.rays_per_dot=8"};
    for (std::string const& change : changes) more.insert(more.end(), {"--set", change});
    render("case", more, path(name));
    return nlohmann::json::parse(read("case/summary.json"));
  }
  double largest_displacement() const {
    double most = 0;
    for (double const value : Hdf5Reader(in("case/truth.h5").string()).read("/dots/displacement_px"))
      most = std::max(most, std::abs(value));
    return most;
  }
};

// f = 105 mm at 1000 mm: 105/895. Scale of the displacement for a depth of 32.7 mm and a lever arm of 250 mm:
// amplitudes of 10 % of n - 1 = 2.8e-4 at wavenumbers of 1.5e3/m give tenths of a pixel; without a field it is zero.
TEST_F(BenchmarkSetups, CasePRendersWithAFewDots) {
  write("dots.csv", "x_mm,y_mm\n0,0\n4,-2\n-5,5\n");
  auto const summary =
      summary_of("case_p.toml", {"target.file=" + in("dots.csv").string(), "camera.pixels=[128, 128]"});
  EXPECT_EQ(summary["dots"], 3);
  EXPECT_NEAR(summary["magnification"].get<double>(), 105.0 / 895.0, 1e-15);
  EXPECT_NEAR(summary["step_mm"].get<double>(), 32.7 / 63, 1e-12);
  EXPECT_TRUE(summary["warnings"].empty()) << summary["warnings"];
  EXPECT_GT(largest_displacement(), 0.01);
}

// 20 dots per window of 32 px: 320 on 128 x 128 px; extent 128 px times 10 um times 895/105, rounded up.
TEST_F(BenchmarkSetups, CaseTRendersAPartOfItsView) {
  auto const summary = summary_of("case_t.toml", {"camera.pixels=[128, 128]", "target.extent_mm=[10.9105, 10.9105]"});
  EXPECT_EQ(summary["dots"], 320);
  EXPECT_EQ(summary["step_mm"], 2.5);
  EXPECT_GT(largest_displacement(), 0.01);
}

// Written by gladstone_bench_cases; another mathematical library may round the last digit of a float differently.
TEST_F(BenchmarkSetups, CasePHasTheVolumeOfTheFormula) {
  std::string const file = content(path("case_p_volume.nrrd"));
  constexpr int nodes = 64;
  std::size_t const bytes = sizeof(float) * nodes * nodes * nodes;
  ASSERT_GT(file.size(), bytes);
  std::vector<float> values(bytes / sizeof(float));
  std::memcpy(values.data(), file.data() + file.size() - bytes, bytes);
  double const cell = bench::volume_width / (nodes - 1), first = -bench::volume_width / 2;
  for (std::size_t at = 0; at < values.size(); ++at) {
    auto const place = [&](std::size_t number) { return first + static_cast<double>(number) * cell; };
    double const expected =
        bench::smooth_refractivity({place(at % nodes), place(at / nodes % nodes), place(at / (nodes * nodes))}, 1);
    ASSERT_NEAR(values[at], expected, 1.3e-7 * expected) << "node " << at;
  }
}

// Printed to 1e-6 mm.
TEST_F(BenchmarkSetups, CasePHasTheLatticeOfTheBenchmark) {
  std::vector<Vec2d> const dots = bench::table1_scene(85, 1).dots.centre;
  ASSERT_EQ(dots.size(), 7225u);
  std::istringstream lines(content(path("case_p_dots.csv")));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x_mm,y_mm");
  for (Vec2d const dot : dots) {
    double x = 0, y = 0;
    char comma = 0;
    ASSERT_TRUE(lines >> x >> comma >> y);
    ASSERT_NEAR(x, 1e3 * dot.x, 0.51e-6);
    ASSERT_NEAR(y, 1e3 * dot.y, 0.51e-6);
  }
  EXPECT_FALSE(lines >> line) << line;
}

}  // namespace
}  // namespace gladstone::end_to_end
