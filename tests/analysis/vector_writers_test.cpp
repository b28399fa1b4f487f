// Vectors in the formats of other programs: read back by our own readers, or compared with the bytes that the format
// prescribes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

#include "analysis/vectors/vector_file.h"
#include "render/base/error.h"
#include "render/files/base64.h"
#include "render/files/fields/field_file.h"
#include "render/files/file_kind.h"
#include "tests/support/documented_tables.h"

namespace gladstone::vector_writers_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class VectorWriters : public testing::Test {
 protected:
  VectorWriters() {
    folder_ =
        std::filesystem::temp_directory_path() / ("gladstone_vector_writers_test_" + std::to_string(::getpid()) + "_" +
                                                  testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  ~VectorWriters() override { std::filesystem::remove_all(folder_); }

  std::string write(std::string const& name, DisplacementField const& field) const {
    FileOrigin origin;
    origin.filetype = "gladstone vectors";
    std::string const path = (folder_ / name).string();
    write_vectors(path, field, origin);
    return path;
  }
  static std::string content(std::string const& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

 private:
  std::filesystem::path folder_;
};

/// A grid of 2 rows and 3 columns whose numbers name their place: u = 10 row + column, v = -u.
DisplacementField numbered_grid() {
  DisplacementField field;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      double const number = 10.0 * row + column;
      field.position_px.push_back({15.5 + 16.0 * column, 7.5 + 8.0 * row});
      field.displacement_px.push_back({number, -number});
      field.sigma_px.push_back({0.25, 0.5});
      field.peak_ratio.push_back(2.0);
      field.status.push_back(VectorStatus::valid);
    }
  }
  field.columns = 3;
  field.rows = 2;
  return field;
}

/// Two scattered vectors, the second one invalid.
DisplacementField scattered_pair() {
  DisplacementField field;
  field.position_px = {{1.5, 2.0}, {4.0, 3.25}};
  field.displacement_px = {{0.5, -0.25}, {nan, nan}};
  field.status = {VectorStatus::valid, VectorStatus::invalid};
  return field;
}

std::string bytes_of(std::vector<double> const& values) {
  std::string bytes(values.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Returns the text of a <DataArray> of doubles: base64 of the number of bytes and of the bytes.
std::string vtk_base64(std::vector<double> const& values) {
  std::uint64_t const size = values.size() * sizeof(double);
  return base64(std::string(reinterpret_cast<char const*>(&size), sizeof size) + bytes_of(values));
}

TEST_F(VectorWriters, TecplotHasOneRowPerVectorAndZerosForUnknownValues) {
  EXPECT_EQ(content(write("v.dat", scattered_pair())),
            "TITLE = \"gladstone vectors, px, y and v downwards; unknown values are 0\"\n"
            "VARIABLES = \"x_px\" \"y_px\" \"u_px\" \"v_px\" \"status\" \"u_raw_px\" \"v_raw_px\" \"reason\" "
            "\"ambiguous\"\n"
            "ZONE T=\"vectors\", I=2, J=1, DATAPACKING=POINT\n"
            "1.5 2 0.5 -0.25 0 0.5 -0.25 0 0\n"
            "4 3.25 0 0 3 0 0 0 0\n");
}

TEST_F(VectorWriters, TecplotComesBack) {
  DisplacementField field = numbered_grid();
  field.displacement_px[4] = {nan, nan};
  field.sigma_px[4] = {nan, nan};
  field.status[4] = VectorStatus::masked;
  VectorFile const back = read_vectors(write("v.dat", field));
  EXPECT_EQ(back.format, "gladstone");
  EXPECT_FALSE(back.foreign);
  EXPECT_TRUE(back.complete);
  EXPECT_EQ(back.conventions, VectorConventions{});
  EXPECT_EQ(back.field.columns, 3);
  EXPECT_EQ(back.field.rows, 2);
  ASSERT_EQ(back.field.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(back.field.position_px[i], field.position_px[i]);
    EXPECT_EQ(back.field.status[i], field.status[i]);
    if (i == 4) continue;
    EXPECT_EQ(back.field.displacement_px[i], field.displacement_px[i]);
    EXPECT_EQ(back.field.sigma_px[i], field.sigma_px[i]);
  }
  EXPECT_TRUE(std::isnan(back.field.displacement_px[4].x));
  EXPECT_TRUE(std::isnan(back.field.sigma_px[4].y));
}

// Numbers with 17 significant digits come back to the bit: also the origin of the vectors.
TEST_F(VectorWriters, TecplotComesBackWithTheOriginOfTheVectors) {
  DisplacementField field = numbered_grid();
  for (std::size_t i = 0; i < field.size(); ++i) {
    field.correlation.push_back(1.0 / (3.0 + static_cast<double>(i)));
    field.raw_px.push_back({0.1 * static_cast<double>(i), 1.0 / 7.0});
    field.reason.push_back(VectorReason::measured);
    field.ambiguous.push_back(i == 2 ? Ambiguity::here : Ambiguity::none);
  }
  field.status[3] = VectorStatus::replaced;
  field.reason[3] = VectorReason::neighbours;
  field.correlation[5] = nan;
  DisplacementField const back = read_vectors(write("v.dat", field)).field;
  ASSERT_EQ(back.correlation.size(), field.size());
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(back.correlation[i], field.correlation[i]);
  EXPECT_TRUE(std::isnan(back.correlation[5]));
  EXPECT_EQ(back.raw_px, field.raw_px);
  EXPECT_EQ(back.reason, field.reason);
  EXPECT_EQ(back.ambiguous, field.ambiguous);
  EXPECT_EQ(back.status, field.status);
}

TEST_F(VectorWriters, Hdf5NamesTheAxesOfItsGrids) {
  Hdf5Reader const file(write("v.h5", numbered_grid()));
  EXPECT_THAT(file.shape("/grid/u_px"), ElementsAre(2, 3));
  EXPECT_THAT(file.dimension_scales("/grid/u_px"), ElementsAre("/grid/y_px", "/grid/x_px"));
  EXPECT_THAT(file.dimension_scales("/status"), ElementsAre("/vector"));
  EXPECT_THAT(file.read("/grid/x_px"), ElementsAre(15.5, 31.5, 47.5));
  EXPECT_THAT(file.read("/grid/y_px"), ElementsAre(7.5, 15.5));
  EXPECT_THAT(file.read("/grid/u_px"), ElementsAre(0, 1, 2, 10, 11, 12));
  EXPECT_THAT(file.read("/grid/v_px"), ElementsAre(0, -1, -2, -10, -11, -12));
  EXPECT_THAT(file.read("/vector"), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(file.attribute_of("/grid/x_px", "CLASS"), "DIMENSION_SCALE");
  EXPECT_EQ(file.attribute_of("/grid/x_px", "NAME"), "x_px");
}

TEST_F(VectorWriters, ScatteredHdf5HasNoGrid) {
  Hdf5Reader const file(write("v.h5", scattered_pair()));
  EXPECT_FALSE(file.has("/grid/u_px"));
  EXPECT_THAT(file.dimension_scales("/u_px"), ElementsAre("/vector"));
}

// Scales and their lists contain neither dates nor uninitialised bytes.
TEST_F(VectorWriters, NetcdfOfEqualVectorsHasEqualDatasets) {
  EXPECT_EQ(dataset_sha256(write("a.nc", numbered_grid())), dataset_sha256(write("b.nc", numbered_grid())));
}

// PIVPy (pivpy/io.py, from_arrays): u, v and chc over (y, x, t), in pix.
TEST_F(VectorWriters, NetcdfIsInTheSchemaOfPivpy) {
  DisplacementField field = numbered_grid();
  field.status[1] = VectorStatus::replaced;
  field.status[2] = VectorStatus::masked;
  field.status[3] = VectorStatus::invalid;
  Hdf5Reader const file(write("v.nc", field));
  for (char const* const name : {"/u", "/v", "/chc", "/sigma_u", "/sigma_v", "/peak_ratio", "/status"}) {
    EXPECT_THAT(file.shape(name), ElementsAre(2, 3, 1)) << name;
    EXPECT_THAT(file.dimension_scales(name), ElementsAre("/y", "/x", "/t")) << name;
  }
  EXPECT_THAT(file.read("/x"), ElementsAre(15.5, 31.5, 47.5));
  EXPECT_THAT(file.read("/y"), ElementsAre(7.5, 15.5));
  EXPECT_THAT(file.read("/t"), ElementsAre(0));
  EXPECT_THAT(file.read("/u"), ElementsAre(0, 1, 2, 10, 11, 12));
  EXPECT_THAT(file.read("/chc"), ElementsAre(1, 1, 0, 0, 1, 1));
  EXPECT_THAT(file.read("/status"), ElementsAre(0, 1, 2, 3, 0, 0));
  for (char const* const name : {"/x", "/y", "/u", "/v", "/sigma_u"})
    EXPECT_EQ(file.attribute_of(name, "units"), "pix");
  EXPECT_EQ(file.attribute_of("/t", "units"), "frame");
  EXPECT_EQ(file.attribute_of("/u", "standard_name"), "u_velocity");
  EXPECT_EQ(file.attribute("pivpy_schema_version"), "1");
}

TEST_F(VectorWriters, VtkImageComesBackAsAField) {
  std::string const path = write("v.vti", numbered_grid());
  EXPECT_EQ(file_kind(path), "VTK");
  auto const source = open_field(path, "displacement_px", 3);
  EXPECT_THAT(source->grid().nodes, ElementsAre(3, 2, 1));
  EXPECT_EQ(source->grid().spacing.x, 16.0);
  EXPECT_EQ(source->grid().spacing.y, 8.0);
  EXPECT_EQ(source->grid().origin.x, 15.5);
  EXPECT_EQ(source->grid().origin.y, 7.5);
  std::vector<double> values(18);
  source->read_planes(0, 1, values);
  EXPECT_THAT(values, ElementsAre(0, 0, 0, 1, -1, 0, 2, -2, 0, 10, -10, 0, 11, -11, 0, 12, -12, 0));
  auto const ratio = open_field(path, "peak_ratio");
  std::vector<double> ratios(6);
  ratio->read_planes(0, 1, ratios);
  EXPECT_THAT(ratios, testing::Each(2.0));
}

TEST_F(VectorWriters, VtkPointsHaveOneVertexPerVector) {
  std::string const text = content(write("v.vtp", scattered_pair()));
  EXPECT_THAT(text, StartsWith("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\""));
  EXPECT_THAT(text, HasSubstr("<Piece NumberOfPoints=\"2\" NumberOfVerts=\"2\">"));
  EXPECT_THAT(text, HasSubstr("Name=\"displacement_px\" NumberOfComponents=\"3\" format=\"binary\">\n" +
                              vtk_base64({0.5, -0.25, 0, nan, nan, 0}) + '\n'));
  EXPECT_THAT(text, HasSubstr("<Points>\n<DataArray type=\"Float64\" Name=\"position_px\" NumberOfComponents=\"3\" "
                              "format=\"binary\">\n" +
                              vtk_base64({1.5, 2, 0, 4, 3.25, 0}) + '\n'));
  std::int32_t const status[] = {0, 3};
  std::uint64_t const size = sizeof status;
  EXPECT_THAT(text,
              HasSubstr("<DataArray type=\"Int32\" Name=\"status\" NumberOfComponents=\"1\" format=\"binary\">\n" +
                        base64(std::string(reinterpret_cast<char const*>(&size), sizeof size) +
                               std::string(reinterpret_cast<char const*>(status), sizeof status))));
  EXPECT_THAT(text, testing::Not(HasSubstr("sigma_px"))) << "not estimated";
}

// MathWorks, MAT-File Format, version 5: header of 128 bytes, then one element miMATRIX per variable. A name of up to
// four bytes is stored in its tag.
TEST_F(VectorWriters, MatlabHasTheBytesOfItsFormat) {
  if (std::endian::native != std::endian::little) GTEST_SKIP() << "the expected bytes are little-endian";
  std::string const bytes = content(write("v.mat", scattered_pair()));
  EXPECT_THAT(bytes, StartsWith("MATLAB 5.0 MAT-file"));
  EXPECT_EQ(bytes.substr(124, 4), std::string("\x00\x01IM", 4));
  std::string const flags("\x06\0\0\0\x08\0\0\0\x06\0\0\0\0\0\0\0", 16);
  std::string const sizes("\x05\0\0\0\x08\0\0\0\x02\0\0\0\x01\0\0\0", 16);
  std::string const name("\x01\0\x04\0x_px", 8);
  std::string const values = std::string("\x09\0\0\0\x10\0\0\0", 8) + bytes_of({1.5, 4.0});
  EXPECT_EQ(bytes.substr(128, 8 + 64), std::string("\x0e\0\0\0\x40\0\0\0", 8) + flags + sizes + name + values);
}

TEST_F(VectorWriters, MatlabComesBackAsMatricesOfRowsAndColumns) {
  std::string const path = write("v.mat", numbered_grid());
  EXPECT_EQ(file_kind(path), "MATLAB");
  // axes: MATLAB's first index varies fastest, which is the row (y)
  auto const source = open_field(path, "u_px", 1, "xy");
  EXPECT_THAT(source->grid().nodes, ElementsAre(3, 2, 1));
  std::vector<double> values(6);
  source->read_planes(0, 1, values);
  EXPECT_THAT(values, ElementsAre(0, 1, 2, 10, 11, 12));
}

TEST_F(VectorWriters, FormatsOfGridsRefuseOtherVectors) {
  auto const refusal = [&](std::string const& name, DisplacementField const& field) -> std::string {
    try {
      write(name, field);
    } catch (OutputError const& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("v.nc", scattered_pair()), HasSubstr(".vtp"));
  EXPECT_THAT(refusal("v.vti", scattered_pair()), HasSubstr(".vtp"));
  DisplacementField stretched = numbered_grid();
  for (std::size_t const i : {2, 5}) stretched.position_px[i].x += 1.0;
  EXPECT_THAT(refusal("v.vti", stretched), HasSubstr("uniform spacing"));
  EXPECT_EQ(refusal("v.nc", stretched), "") << "has coordinates of its own";
}

TEST_F(VectorWriters, EmptyFieldsAreWritten) {
  for (std::string const ending : {".h5", ".csv", ".mat", ".dat", ".vtp"})
    EXPECT_NO_THROW(write("empty" + ending, DisplacementField{})) << ending;
}

TEST_F(VectorWriters, DocumentationListsEveryFormat) {
  std::vector<std::string> const endings = vector_extensions();
  EXPECT_EQ(test::names_of_first_column(test::documented_table("Vectors for other programs", "ending")),
            std::set<std::string>(endings.begin(), endings.end()));
}

}  // namespace
}  // namespace gladstone::vector_writers_test
