#include "render/light/velocity_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "render/light/flow.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

constexpr double node_step = unit::millimetre;

/// Writes a cut-out of nodes a millimetre apart about the origin. @param velocity  velocity at a position [m/s, m]
std::string cutout(std::string const& name, std::array<int, 3> nodes, std::function<Vec3d(Vec3d)> const& velocity,
                   std::string const& unit = "m/s") {
  std::string const path = testing::TempDir() + "/velocity_" + name + ".h5";
  std::vector<double> values;
  for (int k = 0; k < nodes[2]; ++k) {
    for (int j = 0; j < nodes[1]; ++j) {
      for (int i = 0; i < nodes[0]; ++i) {
        Vec3d const u =
            velocity(Vec3d{i - (nodes[0] - 1) / 2.0, j - (nodes[1] - 1) / 2.0, k - (nodes[2] - 1) / 2.0} * node_step);
        values.insert(values.end(), {u.x, u.y, u.z});
      }
    }
  }
  auto const size = [](int count) { return static_cast<std::size_t>(count); };
  Hdf5Writer file(path, {"test", 1, "", 0, "cpu"});
  file.write("Velocity_0001", std::span<double const>(values), {size(nodes[2]), size(nodes[1]), size(nodes[0]), 3},
             unit, "test", "z, y, x, component");
  file.close();
  return path;
}

VelocityFile a_millimetre_apart(std::string const& path) {
  VelocityFile setup;
  setup.file = path;
  setup.spacing = Vec3d{node_step, node_step, node_step};
  return setup;
}

/// A velocity that is cubic in X, Y, Z and contains their products [m/s], at most 10 over 6 mm.
Vec3d cubic(Vec3d p) {
  double const x = p.x / node_step, y = p.y / node_step, z = p.z / node_step;
  return {1 + 0.02 * x * x * x - y, 0.05 * x * y * z + 2, z * z - 0.3 * x + 0.01 * y * y * y};
}

// Splines with not-a-knot ends reproduce cubics up to the ends; coefficients are floats, with errors of 6e-8 of 30 m/s.
TEST(VelocityFile, ReproducesACubicBetweenItsNodes) {
  LoadedVelocity const loaded = load_velocity(a_millimetre_apart(cutout("cubic", {7, 6, 5}, cubic)));
  for (double const x : {-3.0, -2.7, 0.1, 2.4, 3.0}) {
    for (double const y : {-2.5, -0.3, 2.5}) {
      for (double const z : {-2.0, -1.5, 0.6, 2.0}) {
        Vec3d const p = Vec3d{x, y, z} * node_step;
        EXPECT_LT(length(loaded.flow(p) - cubic(p)), 1e-5) << x << ' ' << y << ' ' << z;
        EXPECT_TRUE(loaded.flow.covers(p));
      }
    }
  }
  EXPECT_FALSE(loaded.flow.covers(Vec3d{3.01, 0, 0} * node_step));
  EXPECT_FALSE(loaded.flow.covers(Vec3d{0, 0, -2.01} * node_step));
  // beyond the end of the grid, the velocity is that at the end
  EXPECT_LT(length(loaded.flow(Vec3d{9, 0.4, 0} * node_step) - cubic(Vec3d{3, 0.4, 0} * node_step)), 1e-5);
}

// The file is [5, 6, 7, 3]; with exchanged axes, its slowest axis is X. The components remain those along X, Y and Z.
TEST(VelocityFile, TakesAxesInTheOrderOfTheKey) {
  VelocityFile setup = a_millimetre_apart(cutout("exchanged", {7, 6, 5}, cubic));
  setup.axes = "xyz";
  EXPECT_THAT(velocity_grid(setup).nodes, testing::ElementsAre(5, 6, 7));
  LoadedVelocity const loaded = load_velocity(setup);
  Vec3d const p = Vec3d{1.4, -0.7, 2.2} * node_step;
  EXPECT_LT(length(loaded.flow(p) - cubic(Vec3d{p.z, p.y, p.x})), 1e-5);
}

TEST(VelocityFile, PassesOnWhatItsReaderHadToAssume) {
  std::string const path = testing::TempDir() + "/velocity_stretched.h5";
  std::vector<double> const values(2 * 3 * 4 * 3, 1.5), y{0, 1, 3};
  Hdf5Writer file(path, {"test", 1, "", 0, "cpu"});
  file.write("Velocity_0001", values, {2, 3, 4, 3}, "m/s", "test", "z, y, x, component");
  file.write("ycoor", y, {3}, "mm", "test", "node");
  file.close();
  VelocityFile setup;
  setup.file = path;
  LoadedVelocity const loaded = load_velocity(setup);
  EXPECT_THAT(loaded.warnings, testing::Contains(Warns("approximated at flow.file", testing::HasSubstr(": y"))));
  EXPECT_LT(length(loaded.flow(Vec3d{}) - Vec3d{1.5, 1.5, 1.5}), 1e-6);
}

// A velocity of 1500 mm/s; the scale given in the setup replaces the unit of the file.
TEST(VelocityFile, ConvertsTheUnitOfTheFile) {
  auto const uniform = [](Vec3d) { return Vec3d{1500, 0, 0}; };
  VelocityFile setup = a_millimetre_apart(cutout("millimetres", {4, 4, 3}, uniform, "mm/s"));
  EXPECT_NEAR(load_velocity(setup).flow(Vec3d{}).x, 1.5, 1e-6);
  EXPECT_THAT(load_velocity(setup).warnings, testing::IsEmpty());
  setup.scale = 1e-2;
  EXPECT_NEAR(load_velocity(setup).flow(Vec3d{}).x, 15, 1e-5);
  setup = a_millimetre_apart(cutout("kelvin", {4, 4, 3}, uniform, "K"));
  EXPECT_THAT(load_velocity(setup).warnings,
              testing::ElementsAre(Warns("assumed at flow.file", testing::HasSubstr("\"K\""))));
}

// A wave over the period of 16 nodes: the error of a cubic spline is at most (2 pi / 16)^4 / 384 of its amplitude, and
// the wave continues periodically beyond the nodes.
TEST(VelocityFile, RepeatsPeriodicFields) {
  auto const wave = [](Vec3d p) {
    return Vec3d{std::sin(2 * pi * p.x / (16 * node_step)), std::cos(2 * pi * p.y / (16 * node_step)), 0};
  };
  VelocityFile setup = a_millimetre_apart(cutout("wave", {16, 16, 1}, wave));
  setup.extrude = true;
  setup.periodic = {true, true, false};
  setup.scale = 3;
  LoadedVelocity const loaded = load_velocity(setup);
  double const error = 3 * std::pow(2 * pi / 16, 4) / 384;
  for (double const x : {-40.3, -7.9, 0.0, 0.5, 7.8, 31.6}) {
    Vec3d const p = Vec3d{x, 0.7 * x, 5} * node_step;
    EXPECT_LT(length(loaded.flow(p) - 3.0 * wave(p)), 2 * error + 1e-6) << x;
    EXPECT_TRUE(loaded.flow.covers(p));
  }
}

TEST(VelocityFile, RefusesWhatIsNoVelocityAndSaysWhatItAssumes) {
  VelocityFile plane = a_millimetre_apart(cutout("plane", {4, 4, 1}, cubic));
  EXPECT_THAT([&] { load_velocity(plane); }, ThrowsDataError(ErrorCode::wrong_shape, plane.file));
  VelocityFile volume = a_millimetre_apart(cutout("volume", {4, 4, 2}, cubic));
  volume.extrude = true;
  EXPECT_THAT([&] { load_velocity(volume); }, ThrowsDataError(ErrorCode::wrong_shape, volume.file));
  volume.extrude = false;
  EXPECT_THAT(load_velocity(volume).warnings, testing::IsEmpty());
  volume.spacing.reset();
  EXPECT_THAT(load_velocity(volume).warnings, testing::ElementsAre(Warns("assumed at flow.file")));
  EXPECT_GE(velocity_bytes(volume), 4 * 4 * 2 * 3 * sizeof(float));
}

// A flow of kind "file" has zero velocity until its file is loaded.
TEST(VelocityFile, IsReadWhenItIsNeeded) {
  std::string const path = cutout("late", {4, 4, 3}, [](Vec3d) { return Vec3d{7, -2, 1}; });
  SetupDocument document = SetupDocument::from_text(
      "kind = \"file\"\nfile = \"" + path + "\"\nspacing_mm = [2, 2, 2]\ncenter_mm = [0, 0, 5]\nscale = 2.0",
      "flow.toml");
  FlowSetup setup = read_flow_setup(document.root());
  document.finish();
  EXPECT_EQ(setup.flow(Vec3d{}), Vec3d{});
  EXPECT_THAT(load_flow(setup), testing::IsEmpty());
  EXPECT_LT(length(setup.flow(Vec3d{1 * node_step, 0, 4 * node_step}) - Vec3d{14, -4, 2}), 1e-5);
  EXPECT_TRUE(velocity_known(setup, Vec3d{3 * node_step, 3 * node_step, 7 * node_step}));
  EXPECT_FALSE(velocity_known(setup, Vec3d{0, 0, 2.9 * node_step}));
}

}  // namespace
}  // namespace gladstone
