// Three components of gladstone stereo in the formats of other programs, whose numbers come back to the bit.
#include "analysis/vectors/three_components.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "analysis/vectors/vector_readers/text_table.h"
#include "render/files/fields/field_file.h"
#include "tests/support/documented_tables.h"
#include "tests/support/folder_fixture.h"

namespace gladstone::three_components_test {
namespace {

using testing::ElementsAre;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class ThreeComponents : public FolderFixture {
 protected:
  std::string write(std::string const& name, ThreeComponentField const& components = field()) const {
    FileOrigin origin;
    origin.filetype = "gladstone three components";
    write_three_components(in_folder(name), components, origin);
    return in_folder(name);
  }
  /// Two rows of three nodes with numbers that have no short decimal representation; the fifth is not determined, the
  /// sixth rejected.
  static ThreeComponentField field() {
    ThreeComponentField result;
    result.x_mm = {-1.0 / 3, 1.0 / 6, 2.0 / 3};
    result.y_mm = {0.1, 0.7};
    for (int i = 0; i < 6; ++i) {
      double const value = std::sqrt(2.0 + i);
      bool const determined = i != 4;
      auto const known = [&](double number) { return determined ? number : nan; };
      result.z_mm.push_back(0.01 * value);
      result.displacement_mm.push_back({known(value), known(-value / 3), known(1e-17 * value)});
      result.sigma_mm.push_back({known(value / 7), known(value / 11), known(value / 13)});
      result.residual_px.push_back(known(value / 17));
      result.residual_ratio.push_back(known(value / 19));
      result.status.push_back(i < 4 ? VectorStatus::valid : VectorStatus::invalid);
    }
    return result;
  }
  /// Returns field() in a sheet at z = 0 and determined everywhere, as the readers of density and velocity fields
  /// require.
  static ThreeComponentField regular_field() {
    ThreeComponentField result = field();
    result.z_mm.assign(result.z_mm.size(), 0.0);
    result.displacement_mm[4] = {0.3, 0.7, 0.9};
    result.sigma_mm[4] = {0.03, 0.07, 0.09};
    result.residual_px[4] = 0.11;
    result.residual_ratio[4] = 0.13;
    return result;
  }
  static std::vector<double> component(std::vector<Vec3d> const& vectors, int axis) {
    std::vector<double> values;
    for (Vec3d const& vector : vectors) values.push_back(vector[axis]);
    return values;
  }
  /// Quantities by the names of the columns.
  static std::map<std::string, std::vector<double>> columns(ThreeComponentField const& all = field()) {
    std::map<std::string, std::vector<double>> result{
        {"z_mm", all.z_mm}, {"residual_px", all.residual_px}, {"residual_ratio", all.residual_ratio}};
    for (int axis = 0; axis < 3; ++axis) {
      std::string const name(1, "uvw"[axis]);
      result[name + "_mm"] = component(all.displacement_mm, axis);
      result["sigma_" + name + "_mm"] = component(all.sigma_mm, axis);
    }
    for (VectorStatus const status : all.status) result["status"].push_back(static_cast<double>(status));
    return result;
  }
  /// Expects equal numbers to the bit; NaN equals NaN, or `unknown`.
  static void expect_equal(std::vector<double> const& found, std::vector<double> const& expected,
                           std::string const& name, double unknown = nan) {
    ASSERT_EQ(found.size(), expected.size()) << name;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::isnan(expected[i])) {
        EXPECT_TRUE(std::isnan(unknown) ? std::isnan(found[i]) : found[i] == unknown) << name << ' ' << i;
      } else {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(found[i]), std::bit_cast<std::uint64_t>(expected[i]))
            << name << ' ' << i;
      }
    }
  }
};

TEST_F(ThreeComponents, TablesComeBack) {
  for (std::string const name : {"w.csv", "w.dat"}) {
    TextTable const table = read_text_table(write(name));
    EXPECT_EQ(table.names.size(), name == "w.dat" ? 13u : 12u) << name << ": Tecplot marks unknown values";
    for (auto const& [column, values] : columns())
      expect_equal(table.column({column}), values, name + ' ' + column, name == "w.dat" ? 0.0 : nan);
    EXPECT_EQ(table.column({"x_mm"}), (std::vector{-1.0 / 3, 1.0 / 6, 2.0 / 3, -1.0 / 3, 1.0 / 6, 2.0 / 3}));
    EXPECT_EQ(table.column({"y_mm"}), (std::vector{0.1, 0.1, 0.1, 0.7, 0.7, 0.7}));
  }
}

// PIVPy: u, v, w and chc over (y, x, t).
TEST_F(ThreeComponents, NetcdfIsInTheSchemaOfPivpy) {
  Hdf5Reader const file(write("w.nc"));
  auto const expected = columns();
  for (auto const& [name, column] : std::map<std::string, std::string>{{"/u", "u_mm"},
                                                                       {"/v", "v_mm"},
                                                                       {"/w", "w_mm"},
                                                                       {"/sigma_u", "sigma_u_mm"},
                                                                       {"/sigma_v", "sigma_v_mm"},
                                                                       {"/sigma_w", "sigma_w_mm"},
                                                                       {"/z", "z_mm"},
                                                                       {"/residual", "residual_px"},
                                                                       {"/residual_ratio", "residual_ratio"},
                                                                       {"/status", "status"}}) {
    expect_equal(file.read(name), expected.at(column), name);
    EXPECT_THAT(file.shape(name), ElementsAre(2, 3, 1)) << name;
    EXPECT_THAT(file.dimension_scales(name), ElementsAre("/y", "/x", "/t")) << name;
  }
  EXPECT_THAT(file.read("/chc"), ElementsAre(1, 1, 1, 1, 0, 0));
  EXPECT_EQ(file.read("/x"), field().x_mm);
  EXPECT_EQ(file.read("/y"), field().y_mm);
  EXPECT_EQ(file.attribute_of("/w", "units"), "mm");
  EXPECT_EQ(file.attribute_of("/w", "standard_name"), "w_velocity");
}

TEST_F(ThreeComponents, MatlabComesBackAsMatrices) {
  std::string const file = write("w.mat", regular_field());
  for (auto const& [column, values] : columns(regular_field())) {
    auto const source = open_field(file, column, 1, "xy");  // MATLAB's first index, the row, varies fastest
    EXPECT_THAT(source->grid().nodes, ElementsAre(3, 2, 1));
    std::vector<double> found(6);
    source->read_planes(0, 1, found);
    expect_equal(found, values, column);
  }
}

TEST_F(ThreeComponents, VtkImageComesBack) {
  std::string const file = write("w.vti", regular_field());
  for (auto const& [name, vectors] : {std::pair{"displacement_mm", regular_field().displacement_mm},
                                      std::pair{"sigma_mm", regular_field().sigma_mm}}) {
    auto const source = open_field(file, name, 3);
    EXPECT_EQ(source->grid().origin.x, -1.0 / 3);
    EXPECT_EQ(source->grid().origin.y, 0.1);
    std::vector<double> found(18), expected;
    source->read_planes(0, 1, found);
    for (Vec3d const& vector : vectors) expected.insert(expected.end(), {vector.x, vector.y, vector.z});
    expect_equal(found, expected, name);
  }
  for (std::string const name : {"z_mm", "residual_px", "residual_ratio", "status"}) {
    std::vector<double> found(6);
    open_field(file, name)->read_planes(0, 1, found);
    expect_equal(found, columns(regular_field()).at(name), name);
  }
}

TEST_F(ThreeComponents, AreReadFromTheFileOfStereo) {
  FileOrigin origin;
  origin.filetype = "gladstone stereo";
  Hdf5Writer file(in_folder("w.h5"), origin);
  ThreeComponentField const all = field();
  auto const put = [&](char const* name, std::vector<double> const& values) {
    file.write(name, std::span<double const>(values), {values.size()}, "1", "of a test", "value");
  };
  auto const flat = [](std::vector<Vec3d> const& vectors) {
    std::vector<double> values;
    for (Vec3d const& vector : vectors) values.insert(values.end(), {vector.x, vector.y, vector.z});
    return values;
  };
  put("/x_mm", all.x_mm);
  put("/y_mm", all.y_mm);
  put("/displacement_mm", flat(all.displacement_mm));
  put("/sigma_mm", flat(all.sigma_mm));
  put("/residual_px", all.residual_px);
  put("/residual_ratio", all.residual_ratio);
  put("/status", {0, 0, 0, 0, 3, 3});
  file.attribute("/", "sheet_z_mm", 0.5);
  file.attribute("/", "sheet_slope_x", 0.25);
  file.attribute("/", "sheet_slope_y", -0.5);
  file.close();
  ASSERT_TRUE(is_three_component_file(in_folder("w.h5")));
  ThreeComponentField const back = read_three_components(in_folder("w.h5"));
  EXPECT_EQ(back.status, all.status);
  for (int axis = 0; axis < 3; ++axis) {
    expect_equal(component(back.displacement_mm, axis), component(all.displacement_mm, axis), "displacement");
    expect_equal(component(back.sigma_mm, axis), component(all.sigma_mm, axis), "sigma");
  }
  EXPECT_EQ(back.z_mm[4], 0.5 + 0.25 / 6 - 0.5 * 0.7);
  EXPECT_FALSE(is_three_component_file(write("w.csv")));
}

TEST_F(ThreeComponents, DocumentationListsEveryFormat) {
  std::vector<std::string> const endings = three_component_extensions();
  EXPECT_EQ(test::names_of_first_column(test::documented_table("Three components for other programs", "ending")),
            std::set<std::string>(endings.begin(), endings.end()));
}

}  // namespace
}  // namespace gladstone::three_components_test
