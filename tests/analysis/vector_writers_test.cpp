// Vectors in the formats of other programs: read back by our own readers, or compared with the bytes that the format
// prescribes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

#include "analysis/vectors/vector_file.h"
#include "analysis/vectors/vector_writers/vector_columns.h"
#include "render/base/error.h"
#include "render/files/base64.h"
#include "render/files/fields/field_file.h"
#include "render/files/file_kind.h"
#include "render/files/hdf5_file.h"
#include "tests/support/documented_tables.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"
#include "tests/support/folder_fixture.h"

namespace gladstone::vector_writers_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class VectorWriters : public FolderFixture {
 protected:
  std::string write(std::string const& name, DisplacementField const& field) const {
    FileOrigin origin;
    origin.filetype = "gladstone vectors";
    std::string const path = in_folder(name);
    write_vectors(path, field, origin);
    return path;
  }
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
  EXPECT_EQ(
      content(write("v.dat", scattered_pair())),
      "TITLE = \"gladstone vectors, px, y and v downwards; values are 0 where unknown contains 2^k, k = number of "
      "the variable from 0\"\n"
      "VARIABLES = \"x_px\" \"y_px\" \"u_px\" \"v_px\" \"status\" \"u_raw_px\" \"v_raw_px\" \"reason\" "
      "\"ambiguous\" \"unknown\"\n"
      "ZONE T=\"vectors\", I=2, J=1, DATAPACKING=POINT\n"
      "1.5 2 0.5 -0.25 0 0.5 -0.25 0 0 0\n"
      "4 3.25 0 0 3 0 0 0 0 108\n")
      << "u, v and the raw displacement: 2^2 + 2^3 + 2^5 + 2^6";
}

// Files of older versions do not mark unknown values: a 0 is then unknown wherever a measurement cannot be exactly 0.
TEST_F(VectorWriters, TecplotOfOlderVersionsIsRead) {
  std::string const path = in_folder("old.dat");
  std::ofstream(path) << "TITLE = \"gladstone vectors, px, y and v downwards; unknown values are 0\"\n"
                         "VARIABLES = \"x_px\" \"y_px\" \"u_px\" \"v_px\" \"sigma_u_px\" \"sigma_v_px\" \"status\"\n"
                         "ZONE T=\"vectors\", I=2, J=1, DATAPACKING=POINT\n"
                         "1.5 2 0 -0.25 0.1 0.2 0\n4 3.25 0 0 0 0 3\n";
  DisplacementField const field = read_vectors(path).field;
  EXPECT_EQ(field.displacement_px[0], (Vec2d{0, -0.25}));
  EXPECT_EQ(field.sigma_px[0], (Vec2d{0.1, 0.2}));
  EXPECT_TRUE(std::isnan(field.displacement_px[1].x) && std::isnan(field.sigma_px[1].y));
}

TEST_F(VectorWriters, TecplotMarksAreSumsOfPowersOfTwo) {
  for (std::string const mark : {"64", "0.5", "-1", "1e300"}) {
    std::string const path = in_folder("bad.dat");
    std::ofstream(path) << "VARIABLES = x_px y_px u_px v_px status unknown\nZONE I=1\n1 2 3 4 0 " << mark << '\n';
    EXPECT_THAT([&] { read_vectors(path); }, ThrowsDataError(ErrorCode::out_of_range, "bad.dat:3")) << mark;
  }
}

/// Vectors with every quantity, of which some are unknown, and numbers that need all digits.
DisplacementField complete_grid() {
  DisplacementField field;
  for (int i = 0; i < 12; ++i) {
    bool const known = i != 5;
    auto const number = [&](double value) { return known ? value : nan; };
    field.position_px.push_back({0.1 + 1.0 / 3.0 * (i % 4), 0.7 + 1.0 / 7.0 * (i / 4)});
    field.displacement_px.push_back({number(std::sin(i)), number(-std::exp(i))});
    field.sigma_px.push_back({number(1.0 / (i + 3)), i == 7 ? 0.0 : number(1e-17 * i)});
    field.peak_ratio.push_back(i == 2 ? nan : 1 + std::sqrt(i));
    field.status.push_back(known ? static_cast<VectorStatus>(i % 2) : VectorStatus::invalid);
    field.raw_px.push_back({i == 9 ? nan : std::cos(i), 0.0});
    field.correlation.push_back(i == 3 ? 0.0 : number(std::cbrt(i)));
    field.reason.push_back(known ? VectorReason::measured : VectorReason::uncorrelated);
    field.ambiguous.push_back(i == 1 ? Ambiguity::here : Ambiguity::none);
  }
  field.columns = 4;
  field.rows = 3;
  return field;
}

/// Compares quantities bit by bit; every NaN equals every other one.
void expect_equal_columns(DisplacementField const& a, DisplacementField const& b, std::string const& ending) {
  auto const expected = vector_columns(a), found = vector_columns(b);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_EQ(found[k].values.size(), expected[k].values.size()) << ending;
    for (std::size_t i = 0; i < expected[k].values.size(); ++i) {
      double const x = expected[k].values[i], y = found[k].values[i];
      EXPECT_TRUE((std::isnan(x) && std::isnan(y)) ||
                  std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y))
          << ending << ' ' << expected[k].name << ' ' << i << ": " << x << " became " << y;
    }
  }
}

// Doubles come back as they were; text has 17 significant digits, which determine a double.
TEST_F(VectorWriters, EveryFormatComesBackToTheBit) {
  DisplacementField const grid = complete_grid();
  for (std::string const& ending : vector_extensions()) {
    VectorFile const back = read_vectors(write("grid" + ending, grid));
    EXPECT_EQ(back.format, "gladstone") << ending;
    EXPECT_FALSE(back.foreign) << ending;
    EXPECT_EQ(back.field.columns, 4) << ending;
    EXPECT_EQ(back.field.rows, 3) << ending;
    expect_equal_columns(grid, back.field, ending);
  }
  DisplacementField scattered = grid;
  for (std::size_t i = 0; i < grid.size(); ++i) scattered.position_px[i].y += 0.37 * static_cast<double>(i * i);
  scattered.columns = scattered.rows = 0;
  for (std::string const ending : {".h5", ".csv", ".mat", ".dat", ".vtp"}) {
    VectorFile const back = read_vectors(write("points" + ending, scattered));
    EXPECT_EQ(back.field.columns, 0) << ending;
    expect_equal_columns(scattered, back.field, ending);
  }
}

/// Writes u = 10 row + column and v = -u over axes of these sizes, two rows and three columns, in PIVPy's schema.
/// @param valid  value of chc of all vectors but one
std::string write_schema(std::string const& path, std::vector<std::string> const& axes, std::size_t frames,
                         double valid = 1) {
  Hdf5Writer file(path, FileOrigin{});
  std::vector<std::size_t> shape;
  std::vector<std::string> scales;
  for (std::string const& axis : axes) {
    shape.push_back(axis == "y" ? 2 : axis == "x" ? 3 : frames);
    scales.push_back('/' + axis);
  }
  std::vector<double> u, v, chc;
  std::vector<std::size_t> index(axes.size(), 0);
  for (bool done = false; !done;) {
    double number = 0;
    for (std::size_t i = 0; i < axes.size(); ++i)
      number += static_cast<double>(index[i]) * (axes[i] == "y" ? 10 : axes[i] == "x" ? 1 : 100);
    u.push_back(number);
    v.push_back(-number);
    chc.push_back(number == 11 ? 0 : valid);
    std::size_t axis = axes.size();
    while (axis > 0 && ++index[axis - 1] == shape[axis - 1]) index[--axis] = 0;
    done = axis == 0;
  }
  auto const write = [&](std::string const& name, std::vector<double> const& values, auto const& size,
                         std::string const& unit) {
    file.write(name, std::span<double const>(values), size, unit, "", "");
  };
  write("/x", {8, 16, 24}, std::vector<std::size_t>{3}, "pix");
  write("/y", {8, 16}, std::vector<std::size_t>{2}, "pix");
  write("/t", std::vector<double>(frames), std::vector<std::size_t>{frames}, "frame");
  write("/u", u, shape, "pix");
  write("/v", v, shape, "pix");
  write("/chc", chc, shape, "1");
  file.attach_scales({{"/u", scales}, {"/v", scales}, {"/chc", scales}});
  file.close();
  return path;
}

TEST_F(VectorWriters, DataSetsOfPivpyAreReadInAnyOrderOfAxes) {
  for (std::vector<std::string> const& axes :
       {std::vector<std::string>{"y", "x", "t"}, {"t", "y", "x"}, {"x", "y", "t"}, {"x", "y"}}) {
    VectorFile const file = read_vectors(write_schema(in_folder("pivpy.nc"), axes, 1));
    EXPECT_EQ(file.format, "PIVPy");
    EXPECT_TRUE(file.foreign);
    ASSERT_EQ(file.field.size(), 6u);
    EXPECT_EQ(file.field.position_px[5], (Vec2d{24, 16}));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(file.field.displacement_px[i].x, 10.0 * (i / 3) + i % 3);
    EXPECT_EQ(file.field.status[4], VectorStatus::invalid) << "chc is 0";
    EXPECT_EQ(file.field.status[5], VectorStatus::valid);
    EXPECT_THAT(file.warnings, testing::IsEmpty());
  }
  // PIVPy copies the flags of OpenPIV to chc, whose 0 means valid
  VectorFile const flags = read_vectors(write_schema(in_folder("flags.nc"), {"y", "x", "t"}, 1, 0));
  EXPECT_THAT(flags.warnings, ElementsAre(Warns("implausible at flags.nc")));
  EXPECT_EQ(flags.field.status[5], VectorStatus::invalid);
  EXPECT_THAT(
      [&] {
        read_vectors(write_schema(in_folder("two.nc"), {"y", "x", "t"}, 2));
      },
      ThrowsDataError(ErrorCode::wrong_shape, "two.nc"));
  std::ofstream(in_folder("classic.nc"), std::ios::binary) << std::string("CDF\x01\0\0\0\0", 8);
  EXPECT_THAT([&] { read_vectors(in_folder("classic.nc")); }, ThrowsDataError(ErrorCode::unsupported, "classic.nc"));
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

TEST_F(VectorWriters, Hdf5StoresTheVerdictAsCodeAndNumber) {
  using Kind = PairVerdict::Kind;
  DisplacementField field = numbered_grid();
  for (PairVerdict const verdict : {PairVerdict{Kind::uncorrelated}, PairVerdict{Kind::periodic, 8.25}}) {
    field.verdict = verdict;
    EXPECT_EQ(read_vectors(write("v.h5", field)).field.verdict, verdict);
  }
  field.verdict = {};
  EXPECT_EQ(Hdf5Reader(write("v.h5", field)).attribute("verdict_code"), "");
  EXPECT_EQ(read_vectors(write("v.h5", field)).field.verdict, PairVerdict{});
}

TEST_F(VectorWriters, Hdf5OfOlderVersionsHasTheVerdictAsText) {
  std::vector<double> const one{1.0};
  using Kind = PairVerdict::Kind;
  for (auto const& [text, verdict] :
       {std::pair{"does not correlate", PairVerdict{Kind::uncorrelated}},
        {"not judged: there are fewer than 25 windows", PairVerdict{Kind::few_windows, 25}},
        {"not judged: the pattern repeats every 8.25 px", PairVerdict{Kind::periodic, 8.25}},
        {"not judged: the pattern repeats every px", PairVerdict{}},
        {"not judged: for another reason", PairVerdict{}}}) {
    Hdf5Writer file(in_folder("old.h5"), {"gladstone vectors", 1, "", 0, "cpu"});
    for (char const* name : {"x_px", "y_px", "u_px", "v_px", "sigma_u_px", "sigma_v_px", "peak_ratio", "status"}) {
      file.write(std::string("/") + name, one, {1}, "px", "", "vector");
    }
    file.attribute("/", "verdict", std::string(text));
    file.close();
    EXPECT_EQ(read_vectors(in_folder("old.h5")).field.verdict, verdict) << text;
  }
}

TEST(PairVerdict, IsFoundByItsText) {
  for (int kind = 0; kind <= static_cast<int>(PairVerdict::Kind::no_valid_vector); ++kind) {
    PairVerdict verdict{static_cast<PairVerdict::Kind>(kind)};
    if (verdict_text(verdict) != verdict_text({verdict.kind, 17.0})) verdict.number = 17.0;
    EXPECT_EQ(find_verdict(verdict_text(verdict)), verdict) << verdict_text(verdict);
  }
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

TEST_F(VectorWriters, ImagesOfEqualSpacingStoreNoPositions) {
  EXPECT_THAT(content(write("v.vti", numbered_grid())), testing::Not(HasSubstr("position_px")));
  DisplacementField moved = numbered_grid();
  moved.position_px[1].x += 1e-3;
  EXPECT_THAT(content(write("w.vti", moved)), HasSubstr("position_px"));
  EXPECT_EQ(read_vectors(in_folder("w.vti")).field.position_px, moved.position_px);
}

TEST_F(VectorWriters, FilesOfOtherContentAreRefused) {
  auto const vti =
      [&](std::string const& arrays) {
        std::ofstream(in_folder("v.vti"))
            << "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 0 0 0\"><Piece Extent=\"0 1 0 0 0 "
               "0\"><PointData>" +
                   arrays + "</PointData></Piece></ImageData></VTKFile>";
        return in_folder("v.vti");
      };
  std::string const two =
      "<DataArray type=\"Float64\" Name=\"displacement_px\" NumberOfComponents=\"2\">1 2 3 4</DataArray>";
  EXPECT_EQ(read_vectors(vti(two)).field.displacement_px, (std::vector<Vec2d>{{1, 2}, {3, 4}}));
  EXPECT_THAT([&] { read_vectors(vti("")); }, ThrowsDataError(ErrorCode::missing_content, "v.vti"));
  EXPECT_THAT([&] { read_vectors(vti(two + "<DataArray type=\"Int32\" Name=\"status\">0 7</DataArray>")); },
              ThrowsDataError(ErrorCode::out_of_range, "v.vti"));
  EXPECT_THAT([&] { read_vectors(vti(two + "<DataArray type=\"Int32\" Name=\"status\">0</DataArray>")); },
              ThrowsDataError(ErrorCode::damaged, "v.vti"));
  std::string const mat = write("v.mat", scattered_pair());
  std::filesystem::resize_file(mat, 140);
  EXPECT_THAT([&] { read_vectors(mat); }, ThrowsDataError(ErrorCode::damaged, "v.mat"));
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
  auto const refusal = [&](std::string const& name, DisplacementField const& field) {
    return error_of([&] { write(name, field); });
  };
  EXPECT_EQ(refusal("v.nc", scattered_pair()), "output at v.nc");
  EXPECT_EQ(refusal("v.vti", scattered_pair()), "output at v.vti");
  DisplacementField stretched = numbered_grid();
  for (std::size_t const i : {2, 5}) stretched.position_px[i].x += 1.0;
  EXPECT_EQ(refusal("v.vti", stretched), "output at v.vti");
  EXPECT_EQ(refusal("v.nc", stretched), "") << "stores the coordinates separately";
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
