#include <numeric>
#include <sstream>
#include <string>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// The small setup with a field from a file.
std::string file_setup(std::string const& file, std::string const& more = "") {
  return with(small_setup, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
              "kind = \"file\"\nfile = \"" + file + "\"\nspacing_mm = [1.0, 1.0, 1.0]\n" + more);
}

/// Invalid fields, images, vectors and cases: exit code 2, the error has code and file, nothing is written.
class DataErrors : public ProgramFixture {
 protected:
  void write_field(std::string const& name, std::vector<std::size_t> const& shape,
                   std::vector<double> const& values) const {
    Hdf5Writer file(in(name).string(), {"test field", 1, "", 0, "cpu"});
    file.write("density", values, shape, "kg/m^3", "a field", "z, y, x");
    file.close();
  }
  static std::vector<double> ramp(std::size_t count) {
    std::vector<double> values(count);
    std::iota(values.begin(), values.end(), 1.0);
    return values;
  }
};

TEST_F(DataErrors, MissingFieldFileStandsAtItsLine) {
  std::string const text = file_setup("nowhere.h5");
  expect_setup_error(text, "missing_file at setup.toml:" + place_of(text, "file = \"nowhere"));
}

TEST_F(DataErrors, NotAnHdf5File) {
  write("field.h5", "this is a text\n");
  expect_setup_error(file_setup("field.h5"), "wrong_format at field.h5");
}

TEST_F(DataErrors, AnHdf5FileCutShort) {
  write_field("whole.h5", {4, 4, 4}, ramp(64));
  write("field.h5", read("whole.h5").substr(0, 600));
  expect_setup_error(file_setup("field.h5"), "damaged at field.h5");
}

TEST_F(DataErrors, MissingDatasetListsThoseThatExist) {
  write_field("field.h5", {4, 4, 4}, ramp(64));
  std::string const misspelt = file_setup("field.h5", "dataset = \"densitty\"");
  expect_setup_error(misspelt, "missing_content at field.h5", {"\"density\""});
}

TEST_F(DataErrors, WrongRank) {
  write_field("field.h5", {64}, ramp(64));
  expect_setup_error(file_setup("field.h5", "dataset = \"density\""), "wrong_shape at field.h5");
  write_field("field.h5", {8, 8}, ramp(64));
  expect_setup_error(file_setup("field.h5", "dataset = \"density\""), "wrong_shape at field.h5");
  write_field("field.h5", {4, 4, 2, 2}, ramp(64));
  expect_setup_error(file_setup("field.h5", "dataset = \"density\""), "wrong_shape at field.h5");
}

TEST_F(DataErrors, HolesOfTheDatabaseAreCounted) {
  auto values = ramp(64);
  values[3] = values[17] = values[40] = -999.9;
  write_field("field.h5", {4, 4, 4}, values);
  expect_setup_error(file_setup("field.h5"), "invalid_value at field.h5", {"\"density\"", "3 of 64"});
}

TEST_F(DataErrors, NegativeDensitiesAreCountedAndPlaced) {
  auto values = ramp(64);
  values[21] = -2.5;  // node 1, 1, 1 of 4 x 4 x 4
  values[50] = -0.5;
  write_field("field.h5", {4, 4, 4}, values);
  expect_setup_error(file_setup("field.h5", "scale = 0.01"), "out_of_range at field.h5",
                     {"\"density\"", "2 of 64", "x, y, z = 1, 1, 1", "-0.025 kg/m^3"});
  write_field("plane.h5", {1, 8, 8}, ramp(64));
  expect_setup_error(file_setup("plane.h5", "extrude = true\nscale = -0.01"), "out_of_range at plane.h5",
                     {"64 of 64", "-0.64 kg/m^3", "scale"});
}

// An index below one is that of a plasma.
TEST_F(DataErrors, NegativeRefractivitiesAreNone) {
  write_field("plane.h5", {1, 8, 8}, ramp(64));
  write("setup.toml", file_setup("plane.h5", "extrude = true\nquantity = \"refractivity\"\nscale = -1e-7"));
  render("case");
}

TEST_F(DataErrors, TruncatedNrrd) {
  std::string const header =
      "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nendian: little\nencoding: raw\nspacings: 1 1 1\n\n";
  write("field.nrrd", header + std::string(100, '\0'));  // of 256 bytes
  expect_setup_error(file_setup("field.nrrd"), "damaged at field.nrrd");
  write("field.nrrd", "NRRD0004\ntype: float\n");
  expect_setup_error(file_setup("field.nrrd"), "missing_content at field.nrrd");
}

TEST_F(DataErrors, FieldOfUnknownFormat) {
  write("field.xyz", "1 2 3");
  expect_setup_error(file_setup("field.xyz"), "unsupported at field.xyz");
  write("field.vtk", "# vtk DataFile");
  expect_setup_error(file_setup("field.vtk"), "damaged at field.vtk");
}

TEST_F(DataErrors, DotsInsideAVolume) {
  write_field("field.h5", {4, 4, 4}, ramp(64));
  std::string const text = with(file_setup("field.h5"), "[1.0, 1.0, 1.0]", "[1.0, 1.0, 200.0]");
  expect_setup_error(text, "invalid_value at setup.toml:" + place_of(text, "file = \"field"));
}

TEST_F(DataErrors, DotsFromABrokenTable) {
  auto const refused = [&](std::string const& table, std::string const& error) {
    write("dots.csv", table);
    std::string const text = with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\"");
    expect_setup_error(text, error);
  };
  refused("x,y\n1,2\n", "wrong_format at dots.csv:1");
  refused("x_mm,y_mm\n1,2\n1,two\n", "syntax at dots.csv:3");
  refused("x_mm,y_mm\n1,2,3\n", "syntax at dots.csv:2");
  refused("x_mm,y_mm\n", "missing_content at dots.csv");
}

TEST_F(DataErrors, ImagesOfDifferentSize) {
  write_tiff(in("a.tif").string(), Image<std::uint16_t>(64, 64), {});
  write_tiff(in("b.tif").string(), Image<std::uint16_t>(64, 48), {});
  expect_error({"correlate", "a.tif", "b.tif", "-o", "v.csv"}, 2, "wrong_shape at b.tif");
}

TEST_F(DataErrors, ImagesSmallerThanAWindow) {
  write_tiff(in("a.tif").string(), Image<std::uint16_t>(20, 20), {});
  expect_error({"correlate", "a.tif", "a.tif", "-o", "v.csv"}, 2, "wrong_shape at a.tif");
}

TEST_F(DataErrors, WhatIsNoImage) {
  write_tiff(in("a.tif").string(), Image<std::uint16_t>(64, 64), {});
  expect_error({"correlate", "a.tif", "setup.toml", "-o", "v.h5"}, 2, "wrong_format at setup.toml");
  expect_error({"correlate", "a.tif", "nowhere.tif", "-o", "v.h5"}, 2, "missing_file at nowhere.tif");
  write("cut.tif", read("a.tif").substr(0, 300));
  expect_error({"correlate", "a.tif", "cut.tif", "-o", "v.h5"}, 2, "wrong_format at cut.tif");
}

TEST_F(DataErrors, VectorsNeedAPlaceAndAKnownEnding) {
  write_tiff(in("a.tif").string(), Image<std::uint16_t>(64, 64), {});
  expect_error({"correlate", "a.tif", "a.tif"}, 2, "arguments at --output");
  expect_error({"correlate", "a.tif", "a.tif", "--pairing", "pairs"}, 2, "arguments at --output");
  expect_error({"correlate", "a.tif", "a.tif", "-o", "v.txt"}, 2, "output at v.txt");
}

TEST_F(DataErrors, AFolderThatIsNoCase) {
  std::filesystem::create_directory(in("folder"));
  for (std::string const command : {"correlate", "compare"}) {
    expect_error({command, "folder"}, 2, "wrong_format at folder");
    expect_error({command, "nowhere"}, 2,
                 command == "correlate" ? "missing_file at nowhere" : "wrong_format at nowhere");
  }
}

TEST_F(DataErrors, CompareWithoutVectors) {
  render("case");
  expect_error({"compare", "case"}, 2, "missing_file at vectors.h5");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 2, "missing_file at v.csv");
  expect_error({"compare", "case", "--vectors", "case"}, 2, "unreadable_file at case");
  std::filesystem::remove(in("case/truth.h5"));
  expect_error({"compare", "case"}, 2, "missing_file at truth.h5");
}

TEST_F(DataErrors, DamagedTruth) {
  render("case");
  succeed({"correlate", "case"});
  std::string const whole = read("case/truth.h5");
  write("case/truth.h5", whole.substr(0, whole.size() / 2));
  expect_error({"compare", "case"}, 2, "damaged at truth.h5");
  write("case/truth.h5", "rubbish");
  expect_error({"compare", "case"}, 2, "wrong_format at truth.h5");
  write("case/truth.h5", read("case/vectors.h5"));
  expect_error({"compare", "case"}, 2, "missing_content at truth.h5");
}

// Vectors are written as a Tecplot zone, once completely and once without the last vectors that the header declares.
TEST_F(DataErrors, VectorsCutShortAreScoredWithAWarning) {
  render("case");
  succeed({"correlate", "case", "-o", "ours.csv"});
  std::istringstream ours(read("ours.csv"));
  std::string line, rows;
  std::getline(ours, line);
  std::size_t count = 0;
  for (; std::getline(ours, line); ++count) {
    std::istringstream fields(line);
    for (int column = 0; column < 4 && std::getline(fields, line, ','); ++column) rows += line + ' ';
    rows += '\n';
  }
  ASSERT_GT(count, 0u);
  for (std::size_t const missing : {0u, 5u}) {
    write("v.dat",
          "VARIABLES = \"x\", \"y\", \"Vx\", \"Vy\"\nZONE I=" + std::to_string(count + missing) + ", J=1\n" + rows);
    Outcome const outcome = gladstone(
        {"compare", "case", "--vectors", "v.dat", "--conventions", "y-down,v-down,offset=0", "--no-figures", "--json"});
    EXPECT_EQ(outcome.exit_code, missing == 0 ? 0 : 1) << outcome.err;
    auto const is_warned_of = [](Outcome const& ended) {
      auto const warnings = warnings_in(nlohmann::json::parse(ended.out));
      return std::find(warnings.begin(), warnings.end(), "incomplete at v.dat:2") != warnings.end();
    };
    EXPECT_EQ(is_warned_of(outcome), missing > 0) << outcome.err;
    // a report of the case, and of the same frames as a measurement
    std::filesystem::create_directories(in("measured"));
    std::filesystem::copy(in("case/setup.toml"), in("measured/setup.toml"),
                          std::filesystem::copy_options::overwrite_existing);
    for (char const* folder : {"case", "measured"}) {
      Outcome const report = gladstone({"report", folder, "--vectors", "v.dat", "--conventions",
                                        "y-down,v-down,offset=0", "-o", "report.html", "--json"});
      EXPECT_EQ(report.exit_code, missing == 0 ? 0 : 1) << report.err;
      EXPECT_EQ(is_warned_of(report), missing > 0) << report.err;
      nlohmann::json const doubtful = nlohmann::json::parse(report.out)["doubtful"];
      EXPECT_EQ(doubtful, missing == 0 ? nlohmann::json::array() : nlohmann::json::array({"v.dat"}));
    }
  }
}

TEST_F(DataErrors, GarbageAmongTheVectorsHasItsLine) {
  render("case");
  write("v.csv", "x,y,u,v\n10,10,0.1,0.2\n20,10,a lot,0.2\n");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 2, "syntax at v.csv:3");
  write("v.csv", "x,y,u,v\n10,10,0.1\n");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 2, "syntax at v.csv:2");
  write("v.csv", "");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 2, "missing_content at v.csv:1");
  write("v.csv", "x,y,u,v\n10,10,nan,nan\n");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 1, "no_valid_vector at v.csv");
  write("v.csv", "x,y,u,v\n10,10,1000,0\n");
  expect_error({"compare", "case", "--vectors", "v.csv"}, 2, "undetermined at v.csv");
}

}  // namespace
}  // namespace gladstone::end_to_end
