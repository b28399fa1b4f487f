#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Arguments of renderings whose warnings concern no table.
std::vector<std::string> const by_rays{"--set", "render.method=rays"};

/// Setups that are formally valid but probably not intended: they run, with warnings.
class SilentMistakes : public ProgramFixture {
 protected:
  std::string with_field(std::string const& field) const {
    return with(automatic_setup(), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]", field);
  }
  std::vector<std::string> warnings(std::string const& setup, std::vector<std::string> const& more = {}) const {
    write("setup.toml", setup);
    render("case", more);
    return warnings_in(nlohmann::json::parse(read("case/summary.json")));
  }
  double largest_displacement() const {
    double most = 0;
    for (double const d : Hdf5Reader(in("case/truth.h5").string()).read("/dots/displacement_px")) {
      most = std::max(most, std::abs(d));
    }
    return most;
  }
  /// A plane of 33 x 33 nodes that is `width` wide in any unit, with a ramp of 0.02 kg/m^3 from node to node along x.
  void write_plane(std::string const& name, double width, std::string const& unit) const {
    std::vector<double> values, axis;
    for (int i = 0; i < 33; ++i) axis.push_back(width * i / 32);
    for (int j = 0; j < 33; ++j) {
      for (int i = 0; i < 33; ++i) values.push_back(1 + 0.02 * i);
    }
    Hdf5Writer file(in(name).string(), {"test field", 1, "", 0, "cpu"});
    file.write("density", values, {1, 33, 33}, "kg m-3", "a ramp", "z, y, x");
    file.write("xcoor", axis, {33}, unit, "x", "node");
    file.write("ycoor", axis, {33}, unit, "y", "node");
    file.close();
  }
};

// The displacement by a plume in a slab of half thickness h is a fraction erf(h / a) of the total: 0.363 in 10 mm for a
// = 15 mm.
TEST_F(SilentMistakes, PlumeIsTruncatedOnlyOnRequest) {
  std::string const plume = with_field("kind = \"gaussian_plume\"\namplitude_kg_m3 = -0.2\nradius_mm = 15.0");
  EXPECT_THAT(warnings(plume), IsEmpty());
  EXPECT_THAT(read("case/setup.toml"), HasSubstr("thickness_mm = 105.0"));
  double const whole = largest_displacement();
  EXPECT_THAT(warnings(plume, {"--set", "medium.thickness_mm=10"}), Contains("approximated at medium.thickness_mm"));
  // the lever arms of slices differ by 10 % over the plume; their mean is Z_D, and the remaining effect is of second
  // order
  EXPECT_NEAR(largest_displacement() / whole, std::erf(1.0 / 3), 0.01);
}

TEST_F(SilentMistakes, CoordinatesInMetresAreReadAsTheySayThemselves) {
  write_plane("metres.h5", 16e-3, "m");  // no ray reaches its faces
  std::string const field = "kind = \"file\"\nfile = \"metres.h5\"\ndataset = \"density\"\nextrude = true";
  EXPECT_THAT(warnings(with_field(field)), IsEmpty());
  EXPECT_GT(largest_displacement(), 0.1);
}

// Coordinates without a unit are assumed to be millimetres: a field 0.008 mm wide in a view of 4 mm.
TEST_F(SilentMistakes, WarnsOfUnitlessCoordinatesAndInvisibleField) {
  write_plane("unnamed.h5", 8e-3, "");
  std::string const field =
      "kind = \"file\"\nfile = \"unnamed.h5\"\ndataset = \"density\"\nextrude = true\n"
      "center_mm = [1.0, 1.0, 0.0]";
  EXPECT_THAT(warnings(with_field(field), by_rays),
              AllOf(Contains("assumed at medium.field.file"), Contains("implausible at medium.field"),
                    Contains("unsuitable at medium.field")));
}

TEST_F(SilentMistakes, ASpacingInMetresIsWarnedOf) {
  write_plane("plane.h5", 12e-3, "m");
  std::string const field =
      "kind = \"file\"\nfile = \"plane.h5\"\ndataset = \"density\"\nextrude = true\n"
      "spacing_mm = [0.375e-3, 0.375e-3, 0.375e-3]";
  EXPECT_THAT(warnings(with_field(field), by_rays), Contains("implausible at medium.field"));
  EXPECT_THAT(warnings(with_field(field), {"--set", "medium.field.spacing_mm=[0.375, 0.375, 0.375]"}), IsEmpty());
}

TEST_F(SilentMistakes, WarnsOfNegligibleField) {
  EXPECT_THAT(warnings(with_field("kind = \"uniform_gradient\"\ngradient_kg_m4 = [1e-6, 0.0, 0.0]"), by_rays),
              Contains("unsuitable at medium.field"));
  EXPECT_THAT(warnings(with_field("kind = \"none\""), by_rays), Not(Contains("unsuitable at medium.field")));
}

TEST_F(SilentMistakes, WarnsOfUnusedThickness) {
  std::vector<double> values;
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < 9; ++j) {
      for (int i = 0; i < 9; ++i) values.push_back(1 + 0.02 * i);
    }
  }
  Hdf5Writer file(in("volume.h5").string(), {"test field", 1, "", 0, "cpu"});
  file.write("density", values, {5, 9, 9}, "kg m-3", "a ramp", "z, y, x");
  file.close();
  std::string const field = "kind = \"file\"\nfile = \"volume.h5\"\nspacing_mm = [2.0, 2.0, 1.0]";
  EXPECT_THAT(warnings(with_field(field)), IsEmpty());
  EXPECT_THAT(read("case/setup.toml"), HasSubstr("thickness_mm = 4.0"));
  EXPECT_THAT(warnings(with_field(field), {"--set", "medium.thickness_mm=20", "--set", "render.method=rays"}),
              Contains("ignored at medium.thickness_mm"));
}

// 64 px of 10 um are 5.46 mm at the dots and 4.09 mm at the mid-plane.
TEST_F(SilentMistakes, InfoTellsUnitsExtentAndWhatOfAViewIsFilled) {
  write_plane("metres.h5", 2e-3, "m");
  auto json = json_of({"info", "field", "metres.h5", "--dataset", "density"});
  EXPECT_EQ(json["units"]["length"], "m");
  EXPECT_EQ(json["units"]["length_m"], 1.0);
  EXPECT_EQ(json["units"]["values"], "kg m-3");
  EXPECT_TRUE(json["units"]["assumed"].is_null());
  EXPECT_NEAR(json["extent_mm"][0].get<double>(), 2.0, 1e-12);
  EXPECT_TRUE(json["coverage"].is_null());
  json = json_of({"info", "field", "metres.h5", "--dataset", "density", "--setup", "setup.toml"});
  EXPECT_NEAR(json["coverage"]["share"].get<double>(), 4.0 / (4.0915 * 4.0915), 1e-3);

  write_plane("unnamed.h5", 2e-3, "");
  json = json_of({"info", "field", "unnamed.h5", "--dataset", "density"});
  EXPECT_TRUE(json["units"]["length"].is_null());
  EXPECT_THAT(json["units"]["assumed"].get<std::string>(), HasSubstr("mm"));
  EXPECT_THAT(warnings_in(json), Contains("assumed at unnamed.h5"));
  std::string const unnamed = "kind = \"file\"\nfile = \"unnamed.h5\"\ndataset = \"density\"\nextrude = true";
  write("unnamed.toml", with_field(unnamed));
  EXPECT_THAT(warnings_in(json_of({"design", "unnamed.toml"})), Contains("assumed at medium.field.file"));
  write("spaced.toml", with_field(unnamed + "\nspacing_mm = [0.1, 0.1, 0.1]"));
  EXPECT_THAT(warnings_in(json_of({"design", "spaced.toml"})), Not(Contains("assumed at medium.field.file")));
  json = json_of({"info", "field", "unnamed.h5", "--dataset", "density", "--setup", "spaced.toml"});
  EXPECT_THAT(warnings_in(json), IsEmpty());
  EXPECT_THAT(succeed({"info", "field", "unnamed.h5", "--dataset", "density", "--setup", "setup.toml"}),
              AllOf(ContainsWhole("0.002 x 0.002"), HasSubstr("metres"), HasSubstr("kg m-3")));
}

// A MATLAB array of meshgrid, [nz, nx, ny], and a header without a spacing.
TEST_F(SilentMistakes, InfoReportsWhichAxisIsTakenForWhich) {
  std::string const folder = std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/fields/";
  auto json = json_of({"info", "field", folder + "h_matlab_mesh.h5"});
  EXPECT_EQ(json["axes"]["order"], "zxy");
  EXPECT_EQ(json["axes"]["by"], "by the lengths of its coordinates");
  EXPECT_EQ(json["axes"]["shape"], (std::vector<int>{16, 24, 20}));
  EXPECT_EQ(json["nodes"], (std::vector<int>{24, 20, 16}));
  json = json_of({"info", "field", folder + "n_tabs.nrrd", "--axes", "xyz"});
  EXPECT_EQ(json["axes"]["order"], "xyz");
  EXPECT_EQ(json["nodes"], (std::vector<int>{16, 20, 24}));
  EXPECT_EQ(json_of({"info", "field", folder + "v_dir_neg.vti"})["axes"]["turned_round"], "xy");
  EXPECT_THAT(json_of({"info", "field", folder + "n_nan_spacing.nrrd"})["units"]["unknown"].get<std::string>(),
              AllOf(ContainsWhole("axis 3"), ContainsWhole("16 nodes"), HasSubstr(" z")));
  EXPECT_THAT(json_of({"info", "field", folder + "h_stretch.h5"})["notes"][0].get<std::string>(), HasSubstr(": y"));
  EXPECT_THAT(succeed({"info", "field", folder + "h_descx.h5"}),
              HasSubstr("[16, 20, 24] is read as z, y, x (by the lengths of its coordinates); x descends"));
}

// A header without a spacing along z, and a file without coordinates: a spacing of 1 is not printed as if it were in
// the file.
TEST_F(SilentMistakes, InfoReportsSpacingsThatTheFileDoesNotState) {
  std::string const partial = std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/fields/n_nan_spacing.nrrd";
  nlohmann::json json = json_of({"info", "field", partial});
  for (char const* key : {"spacing", "extent_mm", "steepest_gradient"}) {
    EXPECT_TRUE(json[key][0].is_number() && json[key][1].is_number()) << key;
    EXPECT_TRUE(json[key][2].is_null()) << key;
  }
  EXPECT_TRUE(json["units"]["assumed"].is_null());
  EXPECT_THAT(warnings_in(json), Contains("assumed at n_nan_spacing.nrrd"));
  EXPECT_THAT(succeed({"info", "field", partial}), ContainsRegex("spacing along z +unknown  .not stated in the file."));

  Hdf5Writer file(in("bare.h5").string(), {"test field", 1, "", 0, "cpu"});
  file.write("density", std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}, {2, 2, 2}, "kg m-3", "a ramp", "z, y, x");
  file.close();
  json = json_of({"info", "field", "bare.h5"});
  EXPECT_TRUE(json["spacing"][0].is_null());
  EXPECT_EQ(json["extent_mm"][0], 1.0);
  EXPECT_THAT(json["units"]["assumed"].get<std::string>(), ContainsWhole("1 mm"));
  EXPECT_THAT(succeed({"info", "field", "bare.h5"}),
              ContainsRegex("spacing along x +unknown  .not stated in the file."));
}

// The warning of peak locking is given for frames that correlate, and only once.
TEST_F(SilentMistakes, SmallDotsAreWarnedOfOnceAndOnlyWhereFramesCorrelate) {
  std::vector<std::string> const small{"--set", "target.dot_diameter_px=1", "--set", "camera.pixels=[256,256]"};
  render("case", small);
  std::vector<std::string> other = small;
  other.insert(other.end(), {"--set", "target.seed=8"});
  render("other", other);
  auto const locks_once = Contains("unsuitable").Times(1);
  EXPECT_THAT(warnings_in(json_of({"correlate", "case"})), locks_once);
  EXPECT_THAT(warnings_in(json_of({"compare", "case", "--no-figures"})), locks_once);
  auto const correlated = [this](std::string const& flow) {
    std::string const output =
        gladstone({"correlate", "case/reference.tif", flow, "-o", "vectors.csv", "--json", "--quiet"}).out;
    return warnings_in(nlohmann::json::parse(output));
  };
  EXPECT_THAT(correlated("case/flow.tif"), locks_once);
  EXPECT_THAT(correlated("other/flow.tif"), ElementsAre("unreliable"));
  std::filesystem::copy(in("other/flow.tif"), in("case/flow.tif"), std::filesystem::copy_options::overwrite_existing);
  std::string const mixed = gladstone({"correlate", "case", "--json"}).out;
  EXPECT_THAT(warnings_in(nlohmann::json::parse(mixed)), Contains("unreliable"));
  EXPECT_THAT(warnings_in(nlohmann::json::parse(mixed)), Not(locks_once));
}

}  // namespace
}  // namespace gladstone::end_to_end
