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
  expect_refused({"info", "field", "field.vtk", "--figure", "field.vtk"}, 2, {"field.vtk: would be overwritten"});
  write_field("line.vtk", 6, 1, 1);
  Outcome const line = gladstone({"info", "field", "line.vtk", "--figure", "planes.svg"});
  EXPECT_EQ(line.exit_code, 2);
  expect_refused({"info", "particles", "setup.toml", "--figure", "planes.svg"}, 2, {"draws no figure"});
}

}  // namespace
}  // namespace gladstone::end_to_end
