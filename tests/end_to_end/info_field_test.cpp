#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone info field --figure: planes through the middle of a field.
class InfoField : public ProgramFixture {
 protected:
  /// Writes a field of nx x ny x nz nodes 1 mm apart, whose value is 1 + x + 10 y + 100 z.
  void write_field(std::string const& name, int nx, int ny, int nz) const {
    std::string text = "# vtk DataFile Version 3.0\nfield\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS " +
                       std::to_string(nx) + ' ' + std::to_string(ny) + ' ' + std::to_string(nz) +
                       "\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA " + std::to_string(nx * ny * nz) +
                       "\nSCALARS rho float 1\nLOOKUP_TABLE default\n";
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) text += std::to_string(1 + i + 10 * j + 100 * k) + '\n';
      }
    }
    write(name, text);
  }
  /// Returns the number of occurrences of a text in a file.
  int count(std::string const& name, std::string const& piece) const {
    std::string const text = read(name);
    int found = 0;
    for (auto at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1)) ++found;
    return found;
  }
};

TEST_F(InfoField, DrawsThreePlanesWithAxes) {
  write_field("field.vtk", 6, 5, 4);
  auto const json = json_of({"info", "field", "field.vtk", "--figure", "planes.svg", "--quiet"});
  if (!json.contains("figure")) GTEST_SKIP() << "no gnuplot here";
  EXPECT_EQ(count("planes.svg", "x [mm]"), 2);  // the planes z = const and y = const
  EXPECT_EQ(count("planes.svg", "y [mm]"), 2);
  EXPECT_EQ(count("planes.svg", "z [mm]"), 2);
  EXPECT_THAT(read("planes.svg"), HasSubstr("z = "));
}

TEST_F(InfoField, OfASliceIsOnePlane) {
  write_field("field.vtk", 6, 5, 1);
  auto const json = json_of({"info", "field", "field.vtk", "--figure", "planes.svg", "--quiet"});
  if (!json.contains("figure")) GTEST_SKIP() << "no gnuplot here";
  EXPECT_EQ(count("planes.svg", "x [mm]"), 1);
  EXPECT_EQ(count("planes.svg", "z [mm]"), 0);
}

TEST_F(InfoField, RefusesFiguresThatCannotBe) {
  write_field("field.vtk", 6, 5, 4);
  expect_error({"info", "field", "field.vtk", "--figure", "field.vtk"}, 2, "overwrites_input at field.vtk");
  write_field("line.vtk", 6, 1, 1);
  Outcome const line = gladstone({"info", "field", "line.vtk", "--figure", "planes.svg"});
  EXPECT_EQ(line.exit_code, 2);
  expect_error({"info", "particles", "setup.toml", "--figure", "planes.svg"}, 2, "arguments at --figure");
}

// Components are described one by one; a scalar field of the same file by its name.
TEST_F(InfoField, DescribesAVelocityByItsComponents) {
  write("v.csv", "x_mm,y_mm,u_m_s,v_m_s\n0,0,1,2\n1,0,4,5\n0,2,7,8\n1,2,10,11\n");
  auto const json = json_of({"info", "field", "v.csv", "--figure", "v.svg", "--quiet"});
  EXPECT_EQ(json["dataset"], "velocity");
  EXPECT_EQ(json["components"], 3);
  EXPECT_EQ(json["minimum"], nlohmann::json::array({1, 2, 0}));
  EXPECT_EQ(json["maximum"], nlohmann::json::array({10, 11, 0}));
  EXPECT_EQ(json["steepest_gradient"][0], nlohmann::json::array({3, 3, 0}));
  EXPECT_EQ(json["units"]["values"], "m/s");
  if (json.contains("figure")) {
    EXPECT_EQ(count("v.svg", "magnitude"), 1);
  }
  EXPECT_EQ(json_of({"info", "field", "v.csv", "--dataset", "u_m_s"})["maximum"], 10);
  std::string const csv = succeed({"info", "field", "v.csv", "--csv", "--quiet"});
  EXPECT_THAT(csv, HasSubstr("maximum.1,,largest value of v,11,m/s,\n"));
  EXPECT_THAT(csv, HasSubstr("nodes.0,,nodes along x,2,,\n"));
  expect_error({"info", "field", "v.csv", "--dataset", "rho"}, 2, "missing_content at v.csv", {"\"rho\""});
}

}  // namespace
}  // namespace gladstone::end_to_end
