#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "render/base/error.h"
#include "render/files/fields/field_file.h"
#include "render/files/fields/resampled_field.h"
#include "render/files/hdf5_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Files as written by other programs, each with one special property. All contain the same field, rho = 1.2 + 0.02 x +
/// 0.05 y + 0.001 z [kg/m^3], with x, y, z in mm from the centre of 24 x 20 x 16 nodes with spacings of 1, 1.2 and 1.5
/// mm, as a function of the indices.
std::string case_file(std::string const& name) {
  return std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/fields/" + name;
}

/// Gradient of the field along x, y and z [kg/m^3/mm].
struct Slopes {
  double x = 0.02, y = 0.05, z = 0.001;
};

/// Returns the largest difference from the linear field about the centre of the grid [kg/m^3].
double largest_error(FieldSource& source, Slopes const& slopes = {}, Vec3d centre = {}) {
  RegularGrid const& grid = source.grid();
  std::vector<double> values(grid.size());
  source.read_planes(0, grid.nodes[2], values);
  double largest = 0;
  std::size_t next = 0;
  auto const place = [&](int axis, int node) {
    return (node - 0.5 * (grid.nodes[static_cast<std::size_t>(axis)] - 1)) * grid.spacing[axis] + centre[axis];
  };
  for (int z = 0; z < grid.nodes[2]; ++z) {
    for (int y = 0; y < grid.nodes[1]; ++y) {
      for (int x = 0; x < grid.nodes[0]; ++x) {
        double const expected = 1.2 + slopes.x * place(0, x) + slopes.y * place(1, y) + slopes.z * place(2, z);
        largest = std::max(largest, std::abs(values[next++] - expected));
      }
    }
  }
  return largest;
}

/// Values are floats up to 2.01 and hence rounded by up to 2^-24 * 2 = 1.2e-7; coordinates may also be floats, which
/// adds 1e-7.
constexpr double rounding = 2.5e-7;

struct FieldCase {
  char const* file;
  char const* reading;  ///< text of `gladstone info field` about the axes
};
std::ostream& operator<<(std::ostream& out, FieldCase const& one) { return out << one.file; }

class FieldCases : public testing::TestWithParam<FieldCase> {};

TEST_P(FieldCases, GiveTheFieldWithoutAWarning) {
  auto const source = open_field(case_file(GetParam().file), "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(24, 20, 16));
  EXPECT_NEAR(source->grid().spacing.x, 1.0, 1e-6);
  EXPECT_NEAR(source->grid().spacing.y, 1.2, 1e-6);
  EXPECT_NEAR(source->grid().spacing.z, 1.5, 1e-6);
  EXPECT_LT(largest_error(*source), rounding);
  EXPECT_EQ(source->reading().text(), GetParam().reading);
  EXPECT_THAT(source->notes(), IsEmpty());
  EXPECT_THAT(source->units().unknown, IsEmpty());
}

constexpr char by_coordinates[] = "[16, 20, 24] is read as z, y, x (by the lengths of its coordinates)";
constexpr char as_nrrd[] = "[16, 20, 24] is read as z, y, x (the default order)";
constexpr char as_vtk[] = "[16, 20, 24] is read as z, y, x (as VTK defines it)";
INSTANTIATE_TEST_SUITE_P(
    OfOtherPrograms, FieldCases,
    testing::Values(
        FieldCase{"h_group.h5", by_coordinates}, FieldCase{"h_lead1.h5", by_coordinates},
        FieldCase{"h_descx.h5",
                  "[16, 20, 24] is read as z, y, x (by the lengths of its coordinates); x descends "
                  "in the file and is reversed"},
        FieldCase{"h_matlab_mesh.h5", "[16, 24, 20] is read as z, x, y (by the lengths of its coordinates)"},
        FieldCase{"n_ascii.nrrd", as_nrrd}, FieldCase{"n_hex.nrrd", as_nrrd}, FieldCase{"n_bz2.nrrd", as_nrrd},
        FieldCase{"n_minmax.nrrd", as_nrrd}, FieldCase{"n_minmax_cell.nrrd", as_nrrd},
        FieldCase{"n_tabs.nrrd", as_nrrd}, FieldCase{"v_b64_lines.vti", as_vtk}, FieldCase{"v_b64_sep.vti", as_vtk},
        FieldCase{"v_b64_lzma_32.vti", as_vtk}, FieldCase{"v_raw_lz4_32.vti", as_vtk},
        FieldCase{"v_pieces.vti", as_vtk}, FieldCase{"v_single_quotes.vti", as_vtk}, FieldCase{"v_legacy.vtk", as_vtk},
        FieldCase{"v_cell.vti",
                  "[16, 20, 24] is read as z, y, x (as VTK defines it; data of cells, at their centres)"}));

TEST(FieldCase, PlaneHasTwoAxes) {
  auto const source = open_field(case_file("h_2d.h5"), "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(24, 20, 1));
  EXPECT_EQ(source->reading().text(), "[20, 24] is read as y, x (by the lengths of its coordinates)");
  EXPECT_LT(largest_error(*source, {}, {0, 0, 0.75}), rounding);
}

// The header places node (0, 0, 0) at the origin, with x and y along -1: the field, which ascends with the indices,
// descends in space.
TEST(FieldCase, AxesThatRunBackwardsAreTurnedRound) {
  for (char const* const name : {"n_dirs_neg.nrrd", "v_dir_neg.vti"}) {
    auto const source = open_field(case_file(name), "");
    EXPECT_THAT(source->reading().text(), HasSubstr("x, y descend in the file and are reversed")) << name;
    EXPECT_LT(largest_error(*source, {-0.02, -0.05, 0.001}), rounding) << name;
    EXPECT_NEAR(source->grid().origin.x, -23, 1e-12);
    EXPECT_NEAR(source->grid().origin.y, -22.8, 1e-12);
  }
}

// The header assigns the first index to y and the second to x.
TEST(FieldCase, ExchangedDirectionsArePutInOrder) {
  auto const source = open_field(case_file("n_dirs_perm.nrrd"), "");
  EXPECT_THAT(source->grid().nodes, ElementsAre(20, 24, 16));
  EXPECT_EQ(source->grid().spacing, (Vec3d{1.2, 1, 1.5}));
  EXPECT_EQ(source->reading().text(), "[16, 20, 24] is read as z, x, y (by its space directions)");
  EXPECT_LT(largest_error(*source, {0.05, 0.02, 0.001}), rounding);
}

TEST(FieldCase, AxesAreThoseThatTheKeyNames) {
  auto const source = open_field(case_file("n_tabs.nrrd"), "", 1, "xyz");
  EXPECT_THAT(source->grid().nodes, ElementsAre(16, 20, 24));
  EXPECT_EQ(source->reading().text(), "[16, 20, 24] is read as x, y, z (axes = \"xyz\")");
  EXPECT_LT(largest_error(*source, {0.001, 0.05, 0.02}), rounding);
  EXPECT_LT(largest_error(*open_field(case_file("h_matlab_mesh.h5"), "", 1, "zxy")), rounding);
  EXPECT_THAT(
      [] { open_field(case_file("h_matlab_mesh.h5"), "", 1, "zyx"); },
      ThrowsDataError(ErrorCode::wrong_shape, "h_matlab_mesh.h5", HasSubstr("24 coordinates for the 20 nodes")));
  EXPECT_THAT([] { open_field(case_file("n_tabs.nrrd"), "", 1, "yx"); },
              ThrowsDataError(ErrorCode::inconsistent, "n_tabs.nrrd"));
}

// The y coordinates of this file are a hyperbolic tangent of the index and the field is linear in the index: along y,
// the field is smooth.
TEST(FieldCase, StretchedAxisIsResampledWithTheErrorStated) {
  auto const source = open_field(case_file("h_stretch.h5"), "");
  EXPECT_EQ(source->grid().nodes[0], 24);
  EXPECT_EQ(source->grid().nodes[2], 16);
  EXPECT_GT(source->grid().nodes[1], 20);
  ASSERT_EQ(source->notes().size(), 1u);
  EXPECT_THAT(source->notes()[0], Warns("approximated", AllOf(HasSubstr(": y"), HasSubstr("0.08 %"))));
}

// Nodes at 12 sinh(t) / sinh(1), |t| < 1, whose spacings differ by a factor of 1.5. A cubic is reproduced up to
// rounding, and sin(y / 3) within the stated error bound, which is less than ten times the true error.
TEST(FieldCase, StatedErrorOfResamplingBoundsTheTrueOne) {
  fs::path const folder = fs::path(testing::TempDir()) / "field_case_stretched";
  fs::create_directories(folder);
  std::vector<double> y;
  for (int j = 0; j < 25; ++j) y.push_back(12 * std::sinh((j - 12) / 12.0) / std::sinh(1.0));
  auto const cubic = [](double place) { return 1 + place * (0.1 + place * (0.02 - 0.003 * place)); };
  auto const wave = [](double place) { return std::sin(place / 3); };
  auto const open = [&](auto const& f) {
    std::string const path = (folder / "field.h5").string();
    std::vector<double> values;
    for (int z = 0; z < 2; ++z) {
      for (double const place : y) values.insert(values.end(), 3, f(place));
    }
    Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
    writer.write("rho", values, {2, 25, 3}, "1", "test", "z, y, x");
    writer.write("ycoor", y, {25}, "mm", "test", "node");
    writer.close();
    return open_field(path, "");
  };
  auto const error = [](FieldSource& source, auto const& f) {
    RegularGrid const& grid = source.grid();
    std::vector<double> values(grid.size());
    source.read_planes(0, grid.nodes[2], values);
    double largest = 0;
    for (int j = 0; j < grid.nodes[1]; ++j) {
      largest =
          std::max(largest, std::abs(values[static_cast<std::size_t>(j) * 3] - f(grid.origin.y + j * grid.spacing.y)));
    }
    return largest;
  };
  EXPECT_LT(error(*open(cubic), cubic), 1e-12);
  auto const source = open(wave);
  double const true_error = error(*source, wave);
  double const stated = dynamic_cast<ResampledField&>(*source).error_bound();
  EXPECT_GT(true_error, 0.0);
  EXPECT_LT(true_error, stated);
  EXPECT_LT(stated, 10 * true_error);
  fs::remove_all(folder);
}

TEST(FieldCase, UnknownSpacingIsReported) {
  auto const source = open_field(case_file("n_nan_spacing.nrrd"), "");
  EXPECT_EQ(source->units().unknown, "the spacing of axis 3 (16 nodes, taken as z) is unknown in the header");
}

TEST(FieldCase, MissingFiltersAreNamed) {
  auto const says = [](std::string const& filter) {
    return ThrowsDataError(ErrorCode::unsupported, ".h5", HasSubstr(filter));
  };
  EXPECT_THAT([] { open_field(case_file("h_lzf.h5"), ""); }, says("lzf (number 32000)"));
  EXPECT_THAT([] { open_field(case_file("h_zstd.h5"), ""); }, says("zstd (number 32015)"));
}

TEST(FieldCase, GroupsLinksAndDimensionScalesAreFollowed) {
  EXPECT_EQ(open_field(case_file("m2_group.h5"), "")->name(), "data/fields/rho");
  EXPECT_EQ(open_field(case_file("m2_soft.h5"), "")->name(), "raw/rho");
  auto const netcdf = open_field(case_file("m2_netcdf4.h5"), "");
  EXPECT_EQ(netcdf->reading().by, "by its dimension scales");
  EXPECT_EQ(netcdf->units().length, "mm");
  EXPECT_EQ(netcdf->grid().spacing.x, 0.5);
}

TEST(FieldCase, DataOfAnotherSizeThanTheHeaderSaysAreRefused) {
  EXPECT_THAT([] { largest_error(*open_field(case_file("w4_longer.nhdr"), "")); },
              ThrowsDataError(ErrorCode::damaged, "", HasSubstr("31072 bytes")));
}

TEST(FieldCase, UnitsPaddedByBlanksAreTrimmed) {
  auto const source = open_field(case_file("w5_padded_units.h5"), "");
  EXPECT_EQ(source->units().length, "m");
  EXPECT_EQ(source->units().metres(), 1.0);
}

}  // namespace
}  // namespace gladstone
