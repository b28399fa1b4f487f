#include "render/medium/field_volume.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Fixture: each test writes small field files into its own directory.
class FieldVolume : public FolderFixture {
 protected:
  /// Writes a file in the style of JHTDB with values f(i, j, k), and with coordinates of the given step if it is
  /// positive.
  template <class Function>
  MediumSetup file_setup(int nx, int ny, int nz, Function const& f, double coordinate_step = 0,
                         std::string const& length_unit = "mm", std::string const& value_unit = "1") {
    std::vector<double> values;
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) values.push_back(f(i, j, k));
      }
    }
    std::string const path = (folder_ / "field.h5").string();
    Hdf5Writer writer(path, {"test field", 1, "", 0, "cpu"});
    std::vector<std::size_t> const shape{std::size_t(nz), std::size_t(ny), std::size_t(nx)};
    writer.write("/rho", values, shape, value_unit, "test", "z, y, x");
    for (auto [name, count] : {std::pair{"/xcoor", nx}, {"/ycoor", ny}, {"/zcoor", nz}}) {
      if (coordinate_step <= 0) break;
      std::vector<double> axis;
      for (int i = 0; i < count; ++i) axis.push_back(100 + i * coordinate_step);
      writer.write(name, axis, {std::size_t(count)}, length_unit, "test", "node");
    }
    writer.close();
    MediumSetup setup;
    setup.field.kind = FieldKind::file;
    setup.field.file = path;
    setup.field.dataset = "rho";
    return setup;
  }
  static double refractivity(BuiltMedium const& built, Vec3d p) {
    return std::visit([&](auto const& medium) { return medium.sample(p).refractivity; }, built.view);
  }
  static Vec3d gradient(BuiltMedium const& built, Vec3d p) {
    return std::visit([&](auto const& medium) { return medium.sample(p).gradient; }, built.view);
  }
  static Bounds<double> bounds(BuiltMedium const& built) {
    return std::visit([](auto const& medium) { return medium.bounds(); }, built.view);
  }
};

double ramp(int i, int j, int k) { return 1 + i + 10 * j + 100 * k; }

TEST_F(FieldVolume, NodesLieAboutTheCentre) {
  auto setup = file_setup(5, 4, 3, ramp);
  setup.field.quantity = FieldQuantity::refractivity;
  setup.field.scale = 1e-6;
  setup.field.spacing = Vec3d{1e-3, 2e-3, 3e-3};
  setup.field.center = {10e-3, 20e-3, 5e-3};
  for (auto interpolation : {FieldInterpolation::cubic_bspline, FieldInterpolation::trilinear}) {
    setup.interpolation = interpolation;
    BuiltMedium const built = build_medium(setup);
    EXPECT_NEAR(bounds(built).low.x, 8e-3, 1e-17);
    EXPECT_NEAR(bounds(built).high.y, 23e-3, 1e-17);
    EXPECT_NEAR(bounds(built).low.z, 2e-3, 1e-17);
    EXPECT_NEAR(bounds(built).high.z, 8e-3, 1e-17);
    // a linear field is reproduced everywhere; float volume: 1e-7 of the range of 2.3e-4
    EXPECT_NEAR(refractivity(built, {8e-3, 17e-3, 2e-3}), 1e-6 * ramp(0, 0, 0), 1e-10);
    EXPECT_NEAR(refractivity(built, {12e-3, 23e-3, 8e-3}), 1e-6 * ramp(4, 3, 2), 1e-10);
    EXPECT_NEAR(refractivity(built, {10e-3, 20e-3, 5e-3}), 1e-6 * (1 + 2 + 15 + 100), 1e-10);
  }
}

TEST_F(FieldVolume, CoordinatesInTheFileAreMillimetres) {
  auto setup = file_setup(5, 4, 3, ramp, 0.25);
  setup.field.scale = 0.01;
  BuiltMedium const built = build_medium(setup);
  EXPECT_NEAR(built.grid.spacing.x, 0.25e-3, 1e-15);
  EXPECT_NEAR(bounds(built).low.x, -0.5e-3, 1e-15) << "center_mm replaces the origin of the file";
  setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  EXPECT_NEAR(bounds(build_medium(setup)).low.x, -2e-3, 1e-15) << "spacing_mm replaces the coordinates";
}

TEST_F(FieldVolume, UnknownUnitsOfLengthAreRefusedAndKnownOnesConverted) {
  EXPECT_NEAR(build_medium(file_setup(
                               5, 4, 3, [](int, int, int) { return 1.2; }, 1, "ft"))
                  .grid.spacing.x,
              0.3048, 1e-12);
  auto setup = file_setup(
      5, 4, 3, [](int, int, int) { return 1.2; }, 1, "furlong");
  EXPECT_THAT([&] { build_medium(setup); },
              ThrowsDataError(ErrorCode::undetermined, setup.field.file, testing::HasSubstr("furlong")));
  setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  EXPECT_EQ(build_medium(setup).grid.spacing.x, 1e-3);
}

// 1.2e-3 g/cm^3 = 1.2 kg/m^3; the scale given in the setup replaces the unit of the file.
TEST_F(FieldVolume, ValuesAreConvertedFromTheUnitOfTheFile) {
  auto const of_unit = [this](std::string const& unit, std::optional<double> scale = std::nullopt,
                              FieldQuantity quantity = FieldQuantity::density) {
    double const value = quantity == FieldQuantity::density ? 1.2e-3 : 2.7e-4;
    auto setup = file_setup(
        4, 4, 4, [value](int, int, int) { return value; }, 1, "mm", unit);
    setup.field.scale = scale;
    setup.field.quantity = quantity;
    return build_medium(setup);
  };
  using testing::Contains, testing::HasSubstr, testing::IsEmpty;
  double const K = MediumSetup{}.gladstone_dale;
  BuiltMedium const grams = of_unit("g/cm^3");
  EXPECT_NEAR(refractivity(grams, {}), 1.2 * K, 1e-10);  // float volume
  EXPECT_THAT(grams.warnings, IsEmpty());
  EXPECT_NEAR(refractivity(of_unit("g/cm^3", 500), {}), 0.6 * K, 1e-10);
  EXPECT_NEAR(refractivity(of_unit("kg m-3"), {}), 1.2e-3 * K, 1e-13);
  EXPECT_THAT(of_unit("K").warnings, Contains(Warns("assumed at medium.field.file", HasSubstr("\"K\""))));
  EXPECT_THAT(of_unit("kg/m^3", std::nullopt, FieldQuantity::refractivity).warnings,
              Contains(Warns("assumed at medium.field.file")));
  EXPECT_THAT(of_unit("kg/m^3", 1, FieldQuantity::refractivity).warnings, IsEmpty());
}

TEST_F(FieldVolume, QuantitiesBecomeRefractivities) {
  // the same field as density, refractivity and refractive index
  auto const rho = [](int i, int j, int k) { return 1 + 0.125 * i - 0.25 * j + 0.5 * k; };
  double const K = 2.26e-4;
  Vec3d const corner{-2e-3, -2e-3, -2e-3}, centre{};
  auto const expect = [&](MediumSetup setup, double tolerance) {
    setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
    BuiltMedium const built = build_medium(setup);
    EXPECT_NEAR(refractivity(built, corner), 2 * K * rho(0, 0, 0), tolerance);
    EXPECT_NEAR(refractivity(built, centre), 2 * K * rho(2, 2, 2), tolerance);
  };
  auto density = file_setup(5, 5, 5, rho);
  density.field.scale = 2;
  expect(density, 1e-10);
  auto refractivities = file_setup(5, 5, 5, [&](int i, int j, int k) { return K * rho(i, j, k); });
  refractivities.field.quantity = FieldQuantity::refractivity;
  refractivities.field.scale = 2;
  expect(refractivities, 1e-10);
  auto index = file_setup(5, 5, 5, [&](int i, int j, int k) { return (1 + 2 * K * rho(i, j, k)) / 2; });
  index.field.quantity = FieldQuantity::refractive_index;
  index.field.scale = 2;
  // n is read in double, exact to 2e-16; only the difference of n - 1 from the offset is rounded to float
  expect(index, 1e-10);
}

// Files with n in double and n - 1 in double represent the same field: their nodal values agree to a float's ulp of the
// range K g L = 7.2e-6, 4e-13, and the gradients on a grid of 0.1 mm to twice that over a cell, 9e-9 / m of 2.3e-3 / m.
// (With n in float, steps of 1.2e-7 would be half the gradient of a cell.) The integral in Eq. 9 over the thickness is
// K g L_z, since the spline reproduces the ramp.
TEST_F(FieldVolume, RefractiveIndexInDoubleKeepsItsGradient) {
  double const K = 2.26e-4, g = 10, cell = 1e-4;  // [m^3/kg], [kg/m^4], [m]
  auto const excess = [&](int i, int j, int k) { return K * (1.225 + g * cell * (i + 0.5 * j - 0.25 * k)); };
  auto const built = [&](FieldQuantity quantity, double unity, FieldInterpolation interpolation) {
    auto setup = file_setup(33, 5, 11, [&](int i, int j, int k) { return unity + excess(i, j, k); });
    setup.field.quantity = quantity;
    setup.field.spacing = Vec3d{cell, cell, cell};
    setup.interpolation = interpolation;
    return build_medium(setup);
  };
  for (auto interpolation : {FieldInterpolation::cubic_bspline, FieldInterpolation::trilinear}) {
    BuiltMedium const index = built(FieldQuantity::refractive_index, 1, interpolation);
    BuiltMedium const refractivities = built(FieldQuantity::refractivity, 0, interpolation);
    EXPECT_TRUE(index.warnings.empty());
    for (double x = -1.55e-3; x < 1.6e-3; x += 0.13e-3) {
      Vec3d integral{};  // integral of grad n along z
      int const slices = 64;
      double const depth = 10 * cell;
      for (int slice = 0; slice < slices; ++slice) {
        Vec3d const p{x, 0.5e-4, depth * ((slice + 0.5) / slices - 0.5)};
        Vec3d const slope = gradient(index, p);
        EXPECT_NEAR(refractivity(index, p), refractivity(refractivities, p), 1e-12);
        EXPECT_LT(length(slope - gradient(refractivities, p)), 2e-8);
        integral = integral + slope * (depth / slices);
      }
      EXPECT_NEAR(integral.x, K * g * depth, 1e-5 * K * g * depth);
      EXPECT_NEAR(integral.y, 0.5 * K * g * depth, 1e-5 * K * g * depth);
    }
  }
}

TEST_F(FieldVolume, RefractiveIndexInFloatIsWarnedOf) {
  std::string const path = (folder_ / "n.nrrd").string();
  std::vector<float> values;
  for (int i = 0; i < 64; ++i) values.push_back(1.00027f + 1e-6f * static_cast<float>(i % 4));
  std::ofstream(path, std::ios::binary)
      << "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: raw\n\n"
      << std::string(reinterpret_cast<char const*>(values.data()), sizeof(float) * values.size());
  MediumSetup setup;
  setup.field.kind = FieldKind::file;
  setup.field.file = path;
  setup.field.quantity = FieldQuantity::refractive_index;
  setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  auto const warnings = build_medium(setup).warnings;
  ASSERT_EQ(warnings.size(), 1u);
  // an ulp of 1.00027 is 2^-23 = 1.2e-7, 4 % of the range of 3e-6
  EXPECT_THAT(warnings[0], Warns("low_accuracy at medium.field.quantity",
                                 testing::AllOf(testing::HasSubstr("1.2e-07"), testing::HasSubstr("4 %"))));
  setup.field.quantity = FieldQuantity::density;
  setup.field.scale = 1.2;  // without the scale, a density of 1.00027 would cause another warning, see below
  EXPECT_TRUE(build_medium(setup).warnings.empty()) << "a density in float is accurate enough";
}

// Values that are plausible as another quantity or in another unit than the one in which they are read; the ambient
// density is 1.225 kg/m^3.
TEST_F(FieldVolume, ValuesOfAnotherQuantityAreAskedAbout) {
  auto const warnings = [this](double value, FieldQuantity quantity, double scale = 1) {
    auto setup = file_setup(4, 4, 4, [value](int i, int j, int) { return value * (1 + 0.01 * i - 0.01 * j); });
    setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
    setup.field.quantity = quantity;
    setup.field.scale = scale;
    return build_medium(setup).warnings;
  };
  using testing::Contains, testing::HasSubstr, testing::IsEmpty;
  EXPECT_THAT(warnings(2.7e-4, FieldQuantity::density),
              Contains(Warns("implausible at medium.field.quantity", HasSubstr("quantity = \"refractivity\""))));
  EXPECT_THAT(warnings(1.2e-3, FieldQuantity::density),
              Contains(Warns("implausible at medium.field.quantity", HasSubstr("scale = 1000"))));
  EXPECT_THAT(warnings(1.2e-3, FieldQuantity::density, 1000), IsEmpty());
  EXPECT_THAT(warnings(1.2, FieldQuantity::refractivity),
              Contains(Warns("implausible at medium.field.quantity", HasSubstr("quantity = \"density\""))));
  EXPECT_THAT(warnings(2.7e-4, FieldQuantity::refractivity), IsEmpty());
  EXPECT_THAT(warnings(1.2, FieldQuantity::density), IsEmpty());
  EXPECT_THAT(warnings(0.2, FieldQuantity::density), IsEmpty()) << "a hot gas";
  auto index = file_setup(4, 4, 4, [](int i, int, int) { return 1.00027 + 1e-6 * i; });
  index.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  EXPECT_THAT(build_medium(index).warnings,
              Contains(Warns("implausible at medium.field.quantity", HasSubstr("quantity = \"refractive_index\""))));
}

TEST_F(FieldVolume, AxesAreThoseOfTheKey) {
  auto setup = file_setup(5, 4, 3, ramp);  // the file is [3, 4, 5]
  setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  setup.field.scale = 0.01;
  setup.field.axes = "xyz";
  BuiltMedium const built = build_medium(setup);
  EXPECT_NEAR(bounds(built).high.x, 1e-3, 1e-15);
  EXPECT_NEAR(bounds(built).high.z, 2e-3, 1e-15);
  // float volume: 1e-7 of the largest value
  EXPECT_NEAR(refractivity(built, {-1e-3, -1.5e-3, 2e-3}), 0.01 * 2.26e-4 * ramp(4, 0, 0), 1e-10);
}

TEST_F(FieldVolume, UnknownSpacingIsAskedForAndNotesAreWarnings) {
  std::string const folder = std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/fields/";
  MediumSetup setup;
  setup.field.kind = FieldKind::file;
  setup.field.file = folder + "n_nan_spacing.nrrd";
  EXPECT_THAT([&] { build_medium(setup); }, ThrowsDataError(ErrorCode::undetermined, "n_nan_spacing.nrrd"));
  setup.field.spacing = Vec3d{1e-3, 1.2e-3, 1.5e-3};
  BuiltMedium const built = build_medium(setup);
  EXPECT_NEAR(refractivity(built, {2e-3, 3e-3, 4e-3}), 2.26e-4 * (1.2 + 0.04 + 0.15 + 0.004), 1e-10);
  setup.field = {};
  setup.field.kind = FieldKind::file;
  setup.field.file = folder + "h_stretch.h5";
  EXPECT_THAT(build_medium(setup).warnings, testing::Contains(Warns("approximated at medium.field.file")));
}

TEST_F(FieldVolume, ExtrudedPlaneFillsTheThickness) {
  auto setup = file_setup(6, 5, 1, [](int i, int j, int) { return 1.0 + i * i - j; });
  setup.field.extrude = true;
  setup.field.scale = 0.01;
  setup.field.spacing = Vec3d{1e-3, 1e-3, 1e-3};
  setup.field.center = {0, 0, 1e-3};
  setup.thickness = 8e-3;
  BuiltMedium const built = build_medium(setup);
  EXPECT_NEAR(bounds(built).low.z, -3e-3, 1e-17);
  EXPECT_NEAR(bounds(built).high.z, 5e-3, 1e-17);
  EXPECT_NEAR(bounds(built).high.x, 2.5e-3, 1e-17);
  for (double z : {-3e-3, 0.0, 5e-3}) {
    EXPECT_NEAR(refractivity(built, {0.25e-3, 1e-3, z}), 2.26e-4 * 0.01 * (1 + 2.75 * 2.75 - 3), 1e-15);
  }
}

TEST_F(FieldVolume, PeriodicAxesTile) {
  double const cell = 0.5e-3;
  auto setup = file_setup(
      8, 6, 1, [](int i, int j, int) { return 1 + 0.5 * std::sin(2 * M_PI * i / 8.0) * std::cos(2 * M_PI * j / 6.0); });
  setup.field.extrude = true;
  setup.field.spacing = Vec3d{cell, cell, cell};
  setup.field.periodic = {true, true, false};
  BuiltMedium const built = build_medium(setup);
  EXPECT_EQ(bounds(built).high.x, unbounded);
  Vec3d const p{0.3e-3, 0.1e-3, 0};
  // 1e-17: positions of 1e-2 m are rounded to 2e-18 m, times dn/dx of 0.2 /m, and n - 1 to 3e-20
  EXPECT_NEAR(refractivity(built, p), refractivity(built, p + Vec3d{8 * cell, 0, 0}), 1e-17);
  EXPECT_NEAR(refractivity(built, p), refractivity(built, p + Vec3d{-80 * cell, 12 * cell, 0}), 1e-17);
}

// The number of steps that is stated before the field is read agrees with the step size of the built medium. This also
// holds for a plane field, whose spline does not vary along Z, however small its cells are.
TEST_F(FieldVolume, StepsAcrossAreThoseOfTheCoarsestStep) {
  for (bool const extrude : {true, false}) {
    for (auto const interpolation : {FieldInterpolation::cubic_bspline, FieldInterpolation::trilinear}) {
      auto setup = file_setup(8, 7, extrude ? 1 : 6, ramp, 0.01);
      setup.field.extrude = extrude;
      setup.interpolation = interpolation;
      BuiltMedium const built = build_medium(setup);
      Bounds<double> const box = bounds(built);
      EXPECT_NEAR(steps_across(setup) * built.coarsest_step / (box.high.z - box.low.z), 1, 1e-12);
      if (extrude && interpolation == FieldInterpolation::cubic_bspline) {
        EXPECT_DOUBLE_EQ(steps_across(setup), 4);
      }
    }
  }
}

TEST_F(FieldVolume, ShapesThatDoNotFitAreRefused) {
  auto const wrong_shape = ThrowsDataError(ErrorCode::wrong_shape, ".h5");
  auto volume = file_setup(4, 4, 3, ramp);
  volume.field.extrude = true;
  EXPECT_THAT([&] { build_medium(volume); }, wrong_shape);
  auto plane = file_setup(4, 4, 1, ramp);
  EXPECT_THAT([&] { build_medium(plane); }, wrong_shape);
  auto line = file_setup(1, 4, 1, ramp);
  line.field.extrude = true;
  EXPECT_THAT([&] { build_medium(line); }, wrong_shape);
  auto wrong_quantity = file_setup(4, 4, 3, ramp);
  wrong_quantity.field.quantity = FieldQuantity::refractive_index;
  EXPECT_THAT([&] { build_medium(wrong_quantity); },
              ThrowsDataError(ErrorCode::out_of_range, wrong_quantity.field.file));
}

/// Returns a value of /proc/self/status in bytes; negative if there is none.
double process_memory(std::string const& key) {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = -1;
  while (status >> word) {
    if (word == key + ":") status >> kilobytes;
  }
  return kilobytes * 1024;
}

/// Resets the peak of the memory in use (Linux, clear_refs 5).
bool reset_peak() { return static_cast<bool>(std::ofstream("/proc/self/clear_refs") << "5" << std::flush); }

// A volume is read directly into its final memory and filtered in place: there is never a second copy. 256^3 floats are
// 67 MB, so a second copy would need 134; the limit is 1.3 times the size plus 24 MB for the slab being read and the
// threads.
TEST_F(FieldVolume, LoadingNeedsLittleMoreThanTheVolume) {
  constexpr int nodes = 256;
  std::string const path = (folder_ / "volume.nrrd").string();
  {
    std::ofstream out(path, std::ios::binary);
    out << "NRRD0004\ntype: float\ndimension: 3\nsizes: 256 256 256\nspacings: 0.1 0.1 0.1\nendian: little\nencoding: "
           "raw\n\n";
    std::vector<float> plane(nodes * nodes);
    for (int k = 0; k < nodes; ++k) {
      for (std::size_t i = 0; i < plane.size(); ++i)
        plane[i] = 1 + 1e-3f * static_cast<float>((i + static_cast<std::size_t>(k)) % 97);
      out.write(reinterpret_cast<char const*>(plane.data()),
                static_cast<std::streamsize>(plane.size() * sizeof(float)));
    }
  }
  MediumSetup setup;
  setup.field.kind = FieldKind::file;
  setup.field.file = path;
  double const size = 4.0 * nodes * nodes * nodes;
  EXPECT_LT(static_cast<double>(medium_bytes_needed(setup)), 1.03 * size);
  if (!reset_peak()) GTEST_SKIP() << "this system does not report the peak memory of a process";
  double const before = process_memory("VmRSS");
  BuiltMedium const built = build_medium(setup);
  double const grown = process_memory("VmHWM") - before;
  EXPECT_GT(grown, size) << "the measurement itself";
  EXPECT_LT(grown, 1.3 * size + 24e6);
  EXPECT_NEAR(refractivity(built, bounds(built).low), 2.26e-4, 1e-10);
}

}  // namespace
}  // namespace gladstone
