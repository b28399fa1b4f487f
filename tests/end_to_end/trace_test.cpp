#include <cmath>
#include <sstream>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// gladstone trace: where and why given rays end.
class Trace : public ProgramFixture {
 protected:
  struct Row {
    std::string status;
    double x, y, z, dx, dy, dz, path, column, row;
  };
  std::vector<Row> trace(std::string const& rays, std::string const& through) const {
    write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n" + rays);
    succeed({"trace", "setup.toml", "--rays", "rays.csv", "-o", "out.csv", "--through", through});
    std::istringstream text(read("out.csv"));
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line, "status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,col_px,row_px");
    std::vector<Row> rows;
    while (std::getline(text, line)) {
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream fields(line);
      Row row;
      fields >> row.status;
      for (double Row::*value :
           {&Row::x, &Row::y, &Row::z, &Row::dx, &Row::dy, &Row::dz, &Row::path, &Row::column, &Row::row}) {
        std::string word;
        fields >> word;
        row.*value = std::stod(word);
      }
      rows.push_back(row);
    }
    return rows;
  }
};

TEST_F(Trace, ARayThroughAUniformGradientTurnsByTheGradientTimesThePath) {
  auto const rows = trace("0,0,-250,0,0,2\n", "medium");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].status, "alive");
  EXPECT_NEAR(rows[0].z, 5, 1e-12);
  // direction dx = K g L / n, with its square along the axis: 2.26e-4 20 0.01 = 4.52e-5, over n = 1.000277
  double const n = 1 + 2.26e-4 * 1.225;
  EXPECT_NEAR(rows[0].dx, 2.26e-4 * 20 * 0.01 / n, 1e-12);
  EXPECT_NEAR(rows[0].dy, 2.26e-4 * 10 * 0.01 / n, 1e-12);
  // lateral shift: half of that angle times 10 mm
  EXPECT_NEAR(rows[0].x, 0.5 * 2.26e-4 * 20 * 0.01 / n * 10, 1e-10);
  // 245 mm in the ambient and 10 mm of medium, both at n0; the deflection adds 5e-10 of 10 mm
  EXPECT_NEAR(rows[0].path, 245 * n + 10 * n, 1e-6);
  EXPECT_NEAR(std::hypot(rows[0].dx, rows[0].dy, rows[0].dz), 1, 1e-15);
  EXPECT_TRUE(std::isnan(rows[0].column));
}

TEST_F(Trace, RaysThatMissTheMediumAreUnchanged) {
  auto const rows = trace("1,2,-250,0,0.6,-0.8\n1,2,100,3,0,4\n", "medium");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].status, "alive");
  EXPECT_NEAR(rows[0].x, 1, 1e-15);
  EXPECT_NEAR(rows[0].y, 2, 1e-15);
  EXPECT_EQ(rows[0].z, -250);
  EXPECT_NEAR(rows[0].dy, 0.6, 1e-15);
  EXPECT_EQ(rows[0].path, 0);
  EXPECT_NEAR(rows[1].dx, 0.6, 1e-15);  // of unit length
  EXPECT_EQ(rows[1].path, 0);
}

// Directions whose squares overflow or underflow are valid.
TEST_F(Trace, DirectionsMayHaveAnyLength) {
  auto const rows = trace("0,0,-250,3e-3,0,1\n0,0,-250,3e197,0,1e200\n0,0,-250,3e-203,0,1e-200\n", "all");
  ASSERT_EQ(rows.size(), 3u);
  for (Row const& row : rows) {
    EXPECT_EQ(row.status, "alive");
    EXPECT_NEAR(row.dx, rows[0].dx, 1e-15);
    EXPECT_NEAR(row.column, rows[0].column, 1e-9);
  }
}

// The slab of a closed form is infinite along X and Y: a ray along it reaches no exit face.
TEST_F(Trace, ARayAlongAnEndlessSlabIsLostInIt) {
  write("setup.toml", with(small_setup, "[20.0, 10.0, 0.0]", "[0.0, 0.0, 0.0]"));
  auto const rows = trace("0,0,0,1,0,0\n0,0,0,0,-1,1e-200\n", "medium");
  ASSERT_EQ(rows.size(), 2u);
  for (Row const& row : rows) {
    EXPECT_EQ(row.status, "lost_in_medium");
    EXPECT_TRUE(std::isnan(row.x) && std::isnan(row.path));
  }
}

TEST_F(Trace, RowsKeepTheirOrderAndSayWhy) {
  // through the middle of the pupil; outside the stop of 105/11/2 = 4.8 mm; from a dot far outside the view; away from
  // the lens
  auto const rows = trace("0,0,-250,0,0,1\n0,0,-250,0.02,0,1\n100,0,-250,-0.1,0,1\n0,0,100,0,0,-1\n", "all");
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0].status, "alive");
  EXPECT_EQ(rows[1].status, "vignetted");
  EXPECT_EQ(rows[2].status, "missed_sensor");
  EXPECT_EQ(rows[3].status, "missed_lens");
  // Eq. 9: M Z_D K g L / (n0 p), towards falling columns for a gradient along +x and (half of it) falling y
  double const eq9 = 105.0 / 895.0 * 0.25 * 2.26e-4 * 20 * 0.01 / ((1 + 2.26e-4 * 1.225) * 10e-6);
  EXPECT_NEAR(rows[0].column - 31.5, -eq9, 1e-5);
  EXPECT_NEAR((rows[0].row - 31.5) / (rows[0].column - 31.5), -0.5, 1e-3);
  EXPECT_TRUE(std::isnan(rows[0].path)) << "the optical path through a thin lens is undefined";
  EXPECT_TRUE(std::isnan(rows[1].column));
  // z_i = 1 / (1/105 - 1/1000) mm behind the lens
  EXPECT_NEAR(rows[0].z, 750 + 1 / (1 / 105.0 - 1 / 1000.0), 1e-9);
}

TEST_F(Trace, ThroughTheOpticsEndsAtTheLens) {
  auto const rows = trace("0,0,-250,0,0,1\n", "optics");
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].z, 750, 1e-12);
  EXPECT_TRUE(std::isnan(rows[0].column));
  // a thin lens subtracts x / f from the slope
  double const slope = 2.26e-4 * 20 * 0.01 / (1 + 2.26e-4 * 1.225);
  EXPECT_NEAR(rows[0].dx / rows[0].dz, slope - rows[0].x / 105.0, 1e-9);
}

TEST_F(Trace, ATableOfNoRaysGivesOneOfNone) { EXPECT_TRUE(trace("", "all").empty()); }

TEST_F(Trace, BadRaysAreRefusedWithTheirLine) {
  auto const refused = [&](std::string const& table, std::string const& error) {
    write("rays.csv", table);
    expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "out.csv"}, 2, error);
  };
  std::string const header = "x_mm,y_mm,z_mm,dx,dy,dz\n";
  refused("x,y,z\n", "wrong_format at rays.csv:1");
  refused(header + "0,0,-250,0,0,1\n0,0,-250,0,0\n", "syntax at rays.csv:3");
  refused(header + "0,0,-250,0,0,0\n", "syntax at rays.csv:2");
  refused(header + "0,0,nan,0,0,1\n", "syntax at rays.csv:2");
  expect_error({"trace", "setup.toml", "--rays", "nowhere.csv", "-o", "out.csv"}, 2, "missing_file at nowhere.csv");
  std::filesystem::create_directory(in("folder"));
  expect_error({"trace", "setup.toml", "--rays", "folder", "-o", "out.csv"}, 2, "unreadable_file at folder");
}

// Far outside a set-up of 1000 mm from the dots to the lens there is nothing to trace.
TEST_F(Trace, RaysFromFarOutsideTheBenchAreRefused) {
  for (std::string const far : {"1e9,0,-250", "0,-1e12,-250", "0,0,10001"}) {
    write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n" + far + ",0,0,1\n");
    expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "out.csv"}, 2, "out_of_range at rays.csv:3");
  }
}

}  // namespace
}  // namespace gladstone::end_to_end
