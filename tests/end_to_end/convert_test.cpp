// gladstone convert: vectors and true displacements in other formats.
#include <cmath>

#include "analysis/vectors/grid_table.h"
#include "analysis/vectors/vector_file.h"
#include "render/files/fields/field_file.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

class Convert : public ProgramFixture {
 protected:
  std::string path(std::string const& name) const { return in(name).string(); }
};

TEST_F(Convert, VectorsOfACaseAreWrittenInEveryFormat) {
  write("setup.toml", small_setup);
  render("case");
  succeed({"correlate", "case"});
  DisplacementField const ours = read_vectors(path("case/vectors.h5")).field;
  for (std::string const& ending : vector_extensions()) {
    auto const json = json_of({"convert", "case/vectors.h5", "-o", "v" + ending});
    EXPECT_EQ(json["vectors"], ours.size()) << ending;
    EXPECT_EQ(json["columns"], ours.columns) << ending;
    EXPECT_TRUE(std::filesystem::exists(in("v" + ending))) << ending;
  }
  auto const scores = json_of({"compare", "case", "--no-figures"});
  for (std::string const& ending : vector_extensions()) {
    std::string const name = "v" + ending;
    VectorFile const back = read_vectors(path(name));
    EXPECT_FALSE(back.foreign) << name;
    EXPECT_EQ(back.field.position_px, ours.position_px) << name;
    EXPECT_EQ(back.field.status, ours.status) << name;
    auto const again = json_of({"compare", "case", "--vectors", name, "--no-figures", "-o", "out" + ending});
    EXPECT_EQ(again["ray_truth"], scores["ray_truth"]) << name;
  }
  Hdf5Reader const original(path("case/vectors.h5")), copy(path("v.h5"));
  for (char const* const attribute : {"setup", "reference_sha256", "flow_sha256", "verdict_code", "device"})
    EXPECT_EQ(copy.attribute(attribute), original.attribute(attribute)) << attribute;
}

// The field readers determine the axes of every format by its coordinates; the plane has more columns than rows.
TEST_F(Convert, DensityIsWrittenInEveryFormat) {
  write("setup.toml", small_setup);
  render("case", {"--set", "camera.pixels=[96, 64]"});
  succeed({"correlate", "case"});
  succeed({"reconstruct", "case", "--reference", "left", "-o", "density.h5", "--no-figures"});
  auto const ours = open_field(path("density.h5"), "");
  EXPECT_EQ(ours->name(), "density_kg_m3");
  RegularGrid const& grid = ours->grid();
  ASSERT_GT(grid.nodes[0], grid.nodes[1]);
  std::vector<double> density(grid.size()), read(grid.size());
  ours->read_planes(0, 1, density);
  Hdf5Reader const file(path("density.h5"));
  EXPECT_THAT(file.dimension_scales("/gradient_kg_m4"), testing::ElementsAre("/y_mm", "/x_mm", "/component"));
  for (std::string const& ending : grid_table_extensions()) {
    std::string const name = "d" + ending;
    auto const json = json_of({"convert", "density.h5", "-o", name});
    EXPECT_EQ(json["format"], "gladstone density") << name;
    EXPECT_EQ(json["nodes"], grid.size()) << name;
    succeed({"reconstruct", "case", "--reference", "left", "-o", "direct" + ending, "--no-figures"});
    for (std::string const& one : {name, "direct" + ending}) {
      auto const field = open_field(path(one), ending == ".nc" ? "density" : "density_kg_m3");
      EXPECT_EQ(field->grid().nodes, grid.nodes) << one;
      EXPECT_NEAR(field->grid().spacing.x, grid.spacing.x, 1e-12) << one;
      EXPECT_NEAR(field->grid().origin.y, grid.origin.y, 1e-12) << one;
      field->read_planes(0, 1, read);
      EXPECT_EQ(read, density) << one;
      EXPECT_EQ(field->units().value_factor(dimension_of_density).factor, 1.0) << one;
    }
  }
  expect_error({"convert", "density.h5", "-o", "d.dat"}, 2, "output at d.dat", {".vti"});
  expect_error({"reconstruct", "case", "--reference", "left", "-o", "d.txt"}, 2, "output at d.txt", {".h5"});
}

TEST_F(Convert, TruthIsWrittenAsVectors) {
  write("setup.toml", small_setup);
  render("case");
  auto const json = json_of({"convert", "case/truth.h5", "-o", "truth.csv"});
  EXPECT_EQ(json["format"], "gladstone truth");
  Hdf5Reader const truth(path("case/truth.h5"));
  auto const place = truth.read("/dots/reference_px"), shift = truth.read("/dots/displacement_px");
  DisplacementField const back = read_vectors(path("truth.csv")).field;
  ASSERT_EQ(2 * back.size(), place.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    bool const seen = std::isfinite(shift[2 * i]) && std::isfinite(shift[2 * i + 1]);
    EXPECT_EQ(back.status[i], seen ? VectorStatus::valid : VectorStatus::invalid);
    if (!seen) continue;
    EXPECT_EQ(back.position_px[i], (Vec2d{place[2 * i], place[2 * i + 1]}));
    EXPECT_EQ(back.displacement_px[i], (Vec2d{shift[2 * i], shift[2 * i + 1]}));
  }
}

// The displacement at every fourth pixel: in the uniform gradient it is that of the dots, to within the scatter of
// their 32 rays over a dot of 3 px (0.02 px, several times their standard error).
TEST_F(Convert, TruthIsWrittenAtPixels) {
  write("setup.toml", small_setup);
  render("case");
  auto const dots = Hdf5Reader(path("case/truth.h5")).read("/dots/displacement_px");
  auto const json = json_of({"convert", "case/truth.h5", "-o", "truth.nc", "--spacing", "4"});
  EXPECT_EQ(json["columns"], 16);
  EXPECT_EQ(json["rows"], 16);
  succeed({"convert", "case/truth.h5", "-o", "truth.mat", "--spacing", "4", "--truth-at", "reference"});
  for (std::string const name : {"truth.nc", "truth.mat"}) {
    DisplacementField const map = read_vectors(path(name)).field;
    ASSERT_EQ(map.size(), 256u) << name;
    EXPECT_EQ(map.position_px[17], (Vec2d{4, 4})) << name;
    EXPECT_NEAR(map.displacement_px[100].x, dots[0], 0.02) << name;
    EXPECT_NEAR(map.displacement_px[100].y, dots[1], 0.02) << name;
  }
  EXPECT_EQ(json_of({"convert", "case/truth.h5", "-o", "truth.csv", "--exact"})["columns"], 64);
  write("v.csv", "x,y,u,v\n1,2,3,4\n");
  expect_error({"convert", "v.csv", "-o", "w.csv", "--spacing", "4"}, 2, "arguments at --spacing");
  expect_error({"convert", "v.csv", "-o", "w.csv", "--exact"}, 2, "arguments at --exact");
}

TEST_F(Convert, ForeignVectorsAreReadByTheirConventions) {
  write("up.dat",
        "VARIABLES = \"x [px]\", \"y [px]\", \"Vx [px]\", \"Vy [px]\", \"isValid\"\nZONE I=2, J=1\n"
        "3 10 1 0.5 1\n7 10 1 0.5 1\n");
  expect_error({"convert", "up.dat", "-o", "v.csv"}, 2, "undetermined at up.dat", {"--image-rows"});
  auto const json = json_of({"convert", "up.dat", "-o", "v.csv", "--image-rows", "64"});
  EXPECT_EQ(json["format"], "DaVis");
  EXPECT_THAT(json["conventions"].get<std::string>(), testing::HasSubstr("y-up-image"));
  DisplacementField const back = read_vectors(path("v.csv")).field;
  EXPECT_EQ(back.position_px[0], (Vec2d{3.0, 53.0})) << "63 - 10";
  EXPECT_EQ(back.displacement_px[0], (Vec2d{1.0, -0.5}));
  json_of({"convert", "up.dat", "-o", "w.csv", "--conventions", "y-down,v-down"});
  EXPECT_EQ(read_vectors(path("w.csv")).field.position_px[0], (Vec2d{3.0, 10.0}));
}

TEST_F(Convert, OtherOutputsAreRefused) {
  write("v.csv", "x,y,u,v\n1,2,3,4\n");
  expect_error({"convert", "v.csv", "-o", "v.xyz"}, 2, "output at v.xyz", {".vtp"});
  expect_error({"convert", "v.csv", "-o", "v.csv"}, 2, "overwrites_input at v.csv");
  expect_error({"convert", "absent.csv", "-o", "v.vtp"}, 2, "missing_file at absent.csv");
  expect_error({"convert", "v.csv", "-o", "v.nc", "--image-rows", "0"}, 2, "arguments at --image-rows");
}

TEST_F(Convert, ScatteredVectorsAreRefusedByFormatsOfGrids) {
  write("v.csv", "x,y,u,v\n1,2,3,4\n5,7,3,4\n9,1,3,4\n");
  expect_error({"convert", "v.csv", "-o", "v.nc"}, 2, "output at v.nc", {".vtp"});
  expect_error({"convert", "v.csv", "-o", "v.vti"}, 2, "output at v.vti", {".vtp"});
}

}  // namespace
}  // namespace gladstone::end_to_end
