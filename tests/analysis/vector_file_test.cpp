#include "analysis/vectors/vector_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <utility>

#include "analysis/vectors/vector_readers/text_rows.h"
#include "render/base/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class VectorFiles : public FolderFixture {
 protected:
  /// Returns code and place of the error when a file is read.
  std::string problem(std::string const& text) const {
    try {
      read_vectors(write("bad.csv", text));
    } catch (DataError const& error) {
      return code_and_place(error);
    }
    return "no error";
  }
};

FileOrigin origin() {
  FileOrigin origin;
  origin.filetype = "gladstone vectors";
  return origin;
}

DisplacementField small_grid() {
  DisplacementField field;
  double const nan = std::numeric_limits<double>::quiet_NaN();
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      field.position_px.push_back({15.5 + 16.0 * column, 15.5 + 16.0 * row});
      field.displacement_px.push_back({0.1 * column + 1.0 / 3.0, -0.7 * row});
      field.sigma_px.push_back({0.01, nan});
      field.peak_ratio.push_back(1.5 + column);
      field.status.push_back(static_cast<VectorStatus>((row * 3 + column) % 4));
      field.raw_px.push_back({1.0 / 7.0 + column, row == 0 ? nan : 2.0});
      field.correlation.push_back(0.9 - 0.1 * column);
      field.reason.push_back(static_cast<VectorReason>(row * 3 + column + 3));
      field.failed.push_back(static_cast<FailedTest>(row * 3 + column == 5 ? 0 : row * 3 + column));
      field.ambiguous.push_back(column == 1 ? Ambiguity::here : Ambiguity::none);
    }
  }
  field.columns = 3;
  field.rows = 2;
  return field;
}

void expect_equal(DisplacementField const& a, DisplacementField const& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.rows, b.rows);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.position_px[i], b.position_px[i]);
    EXPECT_EQ(a.displacement_px[i], b.displacement_px[i]);
    EXPECT_EQ(a.sigma_px[i].x, b.sigma_px[i].x);
    EXPECT_TRUE(std::isnan(b.sigma_px[i].y));
    EXPECT_EQ(a.peak_ratio[i], b.peak_ratio[i]);
    EXPECT_EQ(a.status[i], b.status[i]);
    EXPECT_EQ(a.raw_px[i].x, b.raw_px[i].x);
    EXPECT_TRUE(a.raw_px[i].y == b.raw_px[i].y || (std::isnan(a.raw_px[i].y) && std::isnan(b.raw_px[i].y)));
    EXPECT_EQ(a.correlation[i], b.correlation[i]);
    EXPECT_EQ(a.reason[i], b.reason[i]);
    EXPECT_EQ(a.ambiguous[i], b.ambiguous[i]);
  }
}

// 17 significant digits reproduce every double exactly.
TEST_F(VectorFiles, CsvComesBackExactly) {
  write_vectors(in_folder("v.csv"), small_grid(), origin());
  VectorFile const back = read_vectors(in_folder("v.csv"));
  EXPECT_EQ(back.format, "gladstone");
  EXPECT_FALSE(back.foreign);
  expect_equal(small_grid(), back.field);
  std::ifstream csv(in_folder("v.csv"));
  std::string header;
  std::getline(csv, header);
  EXPECT_EQ(
      header,
      "x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status,u_raw_px,v_raw_px,correlation,reason,ambiguous");
}

TEST_F(VectorFiles, Hdf5ComesBackExactly) {
  write_vectors(in_folder("v.h5"), small_grid(), origin());
  VectorFile const back = read_vectors(in_folder("v.h5"));
  EXPECT_EQ(back.field.failed, small_grid().failed);
  EXPECT_FALSE(back.foreign);
  expect_equal(small_grid(), back.field);
}

// Vectors without a reason are written as measured.
TEST_F(VectorFiles, VectorsWithoutAnOriginAreTheirOwnRawOnes) {
  DisplacementField field = small_grid();
  field.raw_px.clear();
  field.correlation.clear();
  field.reason.clear();
  field.ambiguous.clear();
  for (std::string const name : {"v.csv", "v.h5"}) {
    write_vectors(in_folder(name), field, origin());
    DisplacementField const back = read_vectors(in_folder(name)).field;
    for (std::size_t i = 0; i < field.size(); ++i) {
      EXPECT_EQ(back.raw_px[i], field.displacement_px[i]);
      EXPECT_TRUE(std::isnan(back.correlation[i]));
      EXPECT_EQ(back.reason[i], VectorReason::measured);
      EXPECT_EQ(back.ambiguous[i], Ambiguity::none);
    }
  }
}

// Files store that a vector is ambiguous, but not since which pass.
TEST_F(VectorFiles, EveryAmbiguityIsWrittenAsOne) {
  DisplacementField field = small_grid();
  field.ambiguous[0] = Ambiguity::earlier;
  write_vectors(in_folder("v.h5"), field, origin());
  EXPECT_EQ(Hdf5Reader(in_folder("v.h5")).read_integers("/ambiguous"), (std::vector<std::int64_t>{1, 1, 0, 0, 1, 0}));
}

TEST_F(VectorFiles, WarningsAreKeptInHdf5) {
  DisplacementField field = small_grid();
  field.warnings = {{WarningCode::unreliable, "", "one"},
                    {WarningCode::excluded, "a b.tif", "two: three"},
                    {WarningCode::assumed, "", "four"}};
  write_vectors(in_folder("v.h5"), field, origin());
  EXPECT_EQ(Hdf5Reader(in_folder("v.h5")).attribute("warnings"), "one\na b.tif: two: three\nfour");
  EXPECT_EQ(read_warnings(Hdf5Reader(in_folder("v.h5"))), field.warnings);
  // files of earlier versions have texts only
  Hdf5Writer old(in_folder("old.h5"), origin());
  old.attribute("/", "warnings", "one\na.tif: two");
  old.close();
  EXPECT_EQ(read_warnings(Hdf5Reader(in_folder("old.h5"))),
            (Warnings{{WarningCode::other, "", "one"}, {WarningCode::other, "", "a.tif: two"}}));
}

TEST_F(VectorFiles, OtherEndingsAreNotWritten) {
  EXPECT_THAT([&] { write_vectors(in_folder("v.txt"), small_grid(), origin()); }, ThrowsOutputError("v.txt"));
}

TEST_F(VectorFiles, OpenPivTextIsRead) {
  VectorFile const back = read_vectors(write("o.txt",
                                             "# x\ty\tu\tv\tflags\tmask\n"
                                             "1.6000e+01\t1.6000e+01\t1.2500e+00\t-5.0000e-01\t0.0000e+00\t0.0000e+00\n"
                                             "3.2000e+01\t1.6000e+01\t2.0000e+00\t0.0000e+00\t1.0000e+00\t0.0000e+00\n"
                                             "1.6000e+01\t3.2000e+01\t3.0000e+00\t0.0000e+00\t2.0000e+00\t0.0000e+00\n"
                                             "3.2000e+01\t3.2000e+01\tnan\tnan\t0.0000e+00\t1.0000e+00\n"));
  EXPECT_EQ(back.format, "OpenPIV");
  EXPECT_TRUE(back.foreign);
  EXPECT_EQ(back.conventions.offset_px, -0.5);
  EXPECT_EQ(back.field.columns, 2);
  EXPECT_EQ(back.field.displacement_px[0], (Vec2d{1.25, -0.5}));
  EXPECT_EQ(back.field.status,
            (std::vector{VectorStatus::valid, VectorStatus::invalid, VectorStatus::replaced, VectorStatus::masked}));
}

TEST_F(VectorFiles, OpenPivCxxTextIsRead) {
  VectorFile const back = read_vectors(write("c.txt",
                                             "# x\ty\tu\tv\tflag\t\n"
                                             " 16.0000\t 16.0000\t  1.2500\t -0.5000\t  0.0000\n"));
  EXPECT_EQ(back.format, "OpenPIV");
  EXPECT_EQ(back.field.displacement_px[0], (Vec2d{1.25, -0.5}));
}

// Older versions write only a mask, which marks invalid vectors, too.
TEST_F(VectorFiles, MaskOfOpenPivWithoutFlagsMarksInvalidVectors) {
  VectorFile const back = read_vectors(write("o.txt", "# x\ty\tu\tv\tmask\n16\t16\t1\t2\t0\n32\t16\t1\t2\t1\n"));
  EXPECT_EQ(back.format, "OpenPIV");
  EXPECT_EQ(back.field.status, (std::vector{VectorStatus::valid, VectorStatus::invalid}));
}

// PIVlab writes with CR LF; with blanks as separator the column names contain blanks themselves.
TEST_F(VectorFiles, PivlabExportIsReadAndPutInRows) {
  for (char const separator : {',', '\t', ' '}) {
    std::string text =
        "PIVlab, ASCII chart output - 21-Nov-2026\r\n"
        "FRAME: 1, filenames: A.tif & B.tif, conversion factor xy (px -> m): 1, conversion factor uv (px/frame -> "
        "m/s): 1\r\n"
        "x [px],y [px],u [px/frame],v [px/frame],Vector type [-]\r\n"
        "17,17,1,10,1\r\n17,33,2,20,2\r\n33,17,3,30,1\r\n33,33,NaN,NaN,0\r\n";
    for (char& c : text) {
      if (c == ',') c = separator;
    }
    VectorFile const back = read_vectors(write("p.txt", text));
    EXPECT_EQ(back.format, "PIVlab");
    EXPECT_EQ(back.conventions.offset_px, -1.5);
    ASSERT_EQ(back.field.columns, 2);
    EXPECT_EQ(back.field.displacement_px[1], (Vec2d{3.0, 30.0}));
    EXPECT_EQ(back.field.displacement_px[2], (Vec2d{2.0, 20.0}));
    EXPECT_EQ(back.field.status,
              (std::vector{VectorStatus::valid, VectorStatus::valid, VectorStatus::replaced, VectorStatus::masked}));
  }
}

// 0.5 mm and 2 m/s per pixel. Without these factors the file cannot be compared, and the message states what to
// specify.
TEST_F(VectorFiles, CalibratedExportsTakeTheirFactors) {
  VectorFile calibrated = read_vectors(write("p.txt",
                                             "PIVlab, ASCII chart output - today\r\nFRAME: 1\r\n"
                                             "x [mm],y [mm],u [m/s],v [m/s],Vector type [-]\r\n5,6,1,-3,1\r\n"));
  EXPECT_EQ(calibrated.place_unit, "mm");
  EXPECT_EQ(calibrated.displacement_unit, "m/s");
  EXPECT_EQ(error_of([&] { convert_to_pixels(calibrated, "p.txt"); }), "undetermined at p.txt");
  override_conventions(calibrated, "px=0.5,px/frame=2");
  EXPECT_FALSE(specifies_reading("px=0.5,px/frame=2"));
  EXPECT_TRUE(specifies_reading("px=0.5, v-up"));
  VectorFile const pixels = convert_to_pixels(calibrated, "p.txt");
  EXPECT_EQ(pixels.field.position_px[0], (Vec2d{10.0, 12.0}));
  EXPECT_EQ(pixels.field.displacement_px[0], (Vec2d{0.5, -1.5}));
}

// One measurement of 49 x 49 vectors as other programs write it (tests/cases/vectors, 512 px high). Read as each format
// specifies, all are equal to their last digit: 1e-6 px; for davis.dat with six digits of up to 5 px, half of 1e-5 px
// in each component; for mm.csv half of 1e-4 / 0.0614 px in each coordinate and, with six digits of up to 31 m/s, half
// of 1e-4 / 6.14 px in each component.
TEST_F(VectorFiles, OtherProgramsFilesAreTheSameVectors) {
  struct Case {
    char const* name;
    char const* format;
    char const* conventions;
    std::size_t invalid = 0;
    double place_px = 1e-6, displacement_px = 2e-6;
  };
  std::string const folder = std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/vectors/";
  auto const in_ours = [&](Case const& one) {
    VectorFile file = read_vectors(folder + one.name);
    EXPECT_EQ(file.format, one.format) << one.name;
    override_conventions(file, one.conventions);
    file = convert_to_pixels(std::move(file), one.name);
    EXPECT_TRUE(file.warnings.empty()) << one.name;
    return apply_conventions(std::move(file.field), file.conventions, 512);
  };
  DisplacementField const expected = in_ours({"semicolon.csv", "named columns", ""});
  ASSERT_EQ(expected.size(), 2401u);
  EXPECT_EQ(expected.position_px[0], (Vec2d{11.5, 11.5}));
  EXPECT_EQ(expected.displacement_px[0], (Vec2d{-0.900597, 0.844581}));
  for (Case const& one : {Case{"jpiv.jvc", "JPIV", ""}, Case{"davis.dat", "DaVis", "", 0, 1e-6, 8e-6},
                          Case{"insight.vec", "Insight", "", 267}, Case{"dantec.csv", "Dantec", ""},
                          Case{"mm.csv", "named columns", "px=0.0614,px/frame=6.14", 0, 1.2e-3, 1.3e-5}}) {
    DisplacementField const field = in_ours(one);
    ASSERT_EQ(field.size(), expected.size()) << one.name;
    EXPECT_EQ(field.columns, 49) << one.name;
    std::size_t invalid = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      EXPECT_LT(length(field.position_px[i] - expected.position_px[i]), one.place_px) << one.name << ' ' << i;
      if (field.counts(i)) {
        EXPECT_LT(length(field.displacement_px[i] - expected.displacement_px[i]), one.displacement_px)
            << one.name << ' ' << i;
      } else {
        ++invalid;
      }
    }
    EXPECT_EQ(invalid, one.invalid) << one.name;
  }
}

TEST_F(VectorFiles, StatusCodesOfOtherProgramsAreConverted) {
  using enum VectorStatus;
  auto const status = [&](std::string const& name, std::string const& text) {
    return read_vectors(write(name, text)).field.status;
  };
  EXPECT_EQ(status("a.vec",
                   "TITLE=\"a\" VARIABLES=\"X mm\", \"Y mm\", \"U m/s\", \"V m/s\", \"CHC\", ZONE I=4, J=1\n"
                   "1, 1, 2, 2, 1\n2, 1, 2, 2, 3\n3, 1, 2, 2, -1\n4, 1, 2, 2, 0\n"),
            (std::vector{valid, replaced, invalid, invalid}));
  EXPECT_EQ(status("b.dat",
                   "TITLE = \"b\"\nVARIABLES = \"x\"\n\"y\"\n\"Vx\" \"Vy\" \"isValid\"\nZONE I=2, J=1\n"
                   "1 1 2 2 1\n2 1 0 0 0\n"),
            (std::vector{valid, masked}));
  EXPECT_EQ(status("c.csv",
                   ">>*HEADER*<<\n>>*DATA*<<\nx;y;x (pix)[pix];y (pix)[pix];U pix[pix];V pix[pix];Status\n"
                   "0;0;1,5;1;2;2;0\n1;0;2,5;1;2;2;16\n2;0;3,5;1;2;2;1\n"),
            (std::vector{valid, replaced, invalid}));
  EXPECT_EQ(status("d.jvc", "1 1 2 2 1.0\n2 1 2 2 -1.0\n"), (std::vector{valid, invalid}));
  VectorFile const zeros = read_vectors(
      write("e.dat", "VARIABLES = \"x\", \"y\", \"Vx\", \"Vy\"\nZONE I=2\n1 1 2 2\n2 1 0 0\nZONE I=1\n9 9 9 9\n"));
  EXPECT_EQ(zeros.field.status, (std::vector{valid, masked}));
  ASSERT_EQ(zeros.warnings.size(), 2u);
  EXPECT_THAT(zeros.warnings[0], Warns("ignored at e.dat:5"));
  EXPECT_THAT(zeros.warnings[1], Warns("assumed at e.dat", HasSubstr("1 of 2")));
  EXPECT_EQ(problem("VARIABLES = x, y, u, v\nZONE I=2, F=BLOCK\n1 2\n1 1\n"), "damaged at bad.csv");
  EXPECT_EQ(problem("x [mm],y [px],u,v\n1,2,3,4\n"), "inconsistent at bad.csv:1");
}

// The header states the size of the grid: with another number of rows, the file was truncated or mixed up.
TEST_F(VectorFiles, RowsAreCountedAgainstTheHeader) {
  struct Case {
    char const* name;
    std::string header, row;
    char const* place;
  };
  for (Case const& one :
       {Case{"a.dat",
             "TITLE = \"ZONE I=9\"\nVARIABLES = \"x\", \"y\", \"Vx\", \"Vy\"\nZONE T=\"J=7\", I=2,\n J = 3, F=POINT\n",
             "1 1 2 2\n", "a.dat:4"},
        Case{"b.vec",
             "TITLE=\"a\" VARIABLES=\"X pixel\", \"Y pixel\", \"U pixel\", \"V pixel\", \"CHC\", ZONE I=2, J=3\n",
             "1, 1, 2, 2, 1\n", "b.vec:1"},
        Case{"c.csv", ">>*HEADER*<<\nGridSize:{Width=2, Height=3}\n>>*DATA*<<\nx,y,U pix,V pix,Status\n", "1,1,2,2,0\n",
             "c.csv:2"},
        Case{"d.txt", "#DaVis 8.0.6 2D-vector 16 2 3 \"position\" \"mm\" \"position\" \"mm\" \"velocity\" \"m/s\"\n",
             "1,0\t1,0\t2,0\t2,0\n", "d.txt:1"}}) {
    std::string text = one.header;
    for (int row = 1; row <= 7; ++row) {
      text += one.row;
      VectorFile const back = read_vectors(write(one.name, text));
      EXPECT_EQ(back.field.size(), static_cast<std::size_t>(row)) << one.name;
      EXPECT_EQ(back.complete, row == 6) << one.name << ' ' << row;
      ASSERT_EQ(back.warnings.size(), row == 6 ? 0u : 1u) << one.name << ' ' << row;
      if (row == 6) continue;
      EXPECT_THAT(back.warnings[0], Warns(std::string("incomplete at ") + one.place,
                                          AllOf(HasSubstr(" 6 "), HasSubstr(std::to_string(row)))));
    }
  }
  EXPECT_TRUE(read_vectors(write("e.csv", "# i = 3\nx,y,u,v\n1,1,2,2\n")).complete) << "no zone";
}

// Text export of DaVis: the units are in its header, and y points upwards as in its .dat files.
TEST_F(VectorFiles, TextExportOfDavisIsRead) {
  VectorFile const back =
      read_vectors(write("d.txt",
                         "#DaVis 8.0.6 2D-vector 16 2 1 \"position\" \"mm\" \"position\" \"mm\" \"velocity\" \"m/s\"\n"
                         "11,5000\t499,5000\t-0,9006\t-0,8446\n21,5\t499,5\t0\t0\n"));
  EXPECT_EQ(back.format, "DaVis");
  EXPECT_EQ(back.place_unit, "mm");
  EXPECT_EQ(back.displacement_unit, "m/s");
  EXPECT_TRUE(back.conventions.y_up && back.conventions.v_up);
  EXPECT_EQ(back.field.position_px[0], (Vec2d{11.5, 499.5}));
  EXPECT_EQ(back.field.displacement_px[0], (Vec2d{-0.9006, -0.8446}));
  EXPECT_EQ(back.field.status, (std::vector{VectorStatus::valid, VectorStatus::masked}));
  VectorFile const downwards =
      read_vectors(write("m.txt",
                         "#DaVis 8.0.6 2D-vector 16 1 2 \"position\" \"mm\" \"position\" \"mm\" \"velocity\" \"m/s\"\n"
                         "11,5\t11,5\t-0,9\t0,8\n11,5\t21,5\t-0,9\t0,8\n"));
  EXPECT_FALSE(downwards.conventions.y_up || downwards.conventions.v_up) << "the first row is the top one";
  VectorFile const pixels = read_vectors(
      write("p.txt",
            "#DaVis 8.4.0 2D-vector 10 1 1 \"position\" \"pixel\" \"position\" \"pixel\" \"displacement\" \"pixel\"\n"
            "1.5\t2.5\t-0.5\t0.25\n"));
  EXPECT_EQ(pixels.place_unit + pixels.displacement_unit, "");
  EXPECT_EQ(problem("#DaVis 8.4.0 3D-vector 10 1 1 \"position\" \"mm\" \"position\" \"mm\" \"velocity\" \"m/s\"\n"
                    "1\t2\t3\t4\t5\n"),
            "unsupported at bad.csv:1");
}

// Validity is read by the column names of other programs, in a table of any program.
TEST_F(VectorFiles, ValidityIsReadByItsName) {
  using enum VectorStatus;
  VectorFile const chc = read_vectors(write("c.csv", "x,y,u,v,chc\n1,1,99,2,-1\n2,1,2,2,1\n3,1,2,2,2\n4,1,2,2,0\n"));
  EXPECT_EQ(chc.field.status, (std::vector{invalid, valid, replaced, invalid}));
  EXPECT_TRUE(chc.notes.empty());
  EXPECT_EQ(read_vectors(write("v.csv", "x,y,u,v,isValid\n1,1,9,2,0\n2,1,2,2,1\n")).field.status,
            (std::vector{masked, valid}));
}

// Without a validity column all vectors are valid; `status` has our codes in any table.
TEST_F(VectorFiles, TablesOfAnyProgramMayHaveOurStatus) {
  using enum VectorStatus;
  for (auto const& [u, v] : {std::pair{"u", "v"}, std::pair{"vx", "vy"}, std::pair{"dx", "dy"}}) {
    std::string const names = std::string("x,y,") + u + ',' + v;
    VectorFile const plain = read_vectors(write("p.csv", names + "\n1,2,0,0\n2,2,3,4\n"));
    EXPECT_EQ(plain.format, "named columns");
    EXPECT_EQ(plain.conventions, VectorConventions{});
    EXPECT_EQ(plain.field.displacement_px[1], (Vec2d{3, 4})) << names;
    EXPECT_EQ(plain.field.status, (std::vector{valid, valid})) << names;
  }
  EXPECT_EQ(read_vectors(write("s.csv", "x,y,u,v,status\n1,1,1,1,0\n2,1,1,1,1\n3,1,1,1,2\n4,1,1,1,3\n")).field.status,
            (std::vector{valid, replaced, masked, invalid}));
}

// A Tecplot file of an unknown program is read as one of DaVis: zeros are masked, with a warning.
TEST_F(VectorFiles, OtherTecplotFilesAreReadAsThoseOfDavis) {
  VectorFile const back = read_vectors(write(
      "t.dat",
      "TITLE = \"any\"\nVARIABLES = \"x\" \"y\" \"u\" \"v\"\nZONE I=2, J=1, DATAPACKING=POINT\n1 9 2 3\n2 9 0 0\n"));
  EXPECT_EQ(back.format, "Tecplot");
  EXPECT_TRUE(back.conventions.y_up && back.conventions.v_up);
  EXPECT_EQ(back.conventions.mirror, VectorConventions::Mirror::image);
  EXPECT_EQ(back.field.status, (std::vector{VectorStatus::valid, VectorStatus::masked}));
  EXPECT_THAT(back.warnings, testing::ElementsAre(testing::Field(&Warning::code, WarningCode::assumed)));
}

// BLOCK packing: all values of a variable, then those of the next one; lines may end anywhere.
TEST_F(VectorFiles, TecplotBlocksAreReadVariableByVariable) {
  std::string const header = "VARIABLES = \"x\" \"y\" \"u\" \"v\" \"isValid\"\nZONE I=3, J=1, DATAPACKING=BLOCK\n";
  DisplacementField const field =
      read_vectors(write("b.dat", header + "1 2 3 10 10\n10 0.5\n0.25 0.125 4 5 6\n1 1 0\n")).field;
  EXPECT_EQ(field.position_px, (std::vector<Vec2d>{{1, 10}, {2, 10}, {3, 10}}));
  EXPECT_EQ(field.displacement_px, (std::vector<Vec2d>{{0.5, 4}, {0.25, 5}, {0.125, 6}}));
  EXPECT_EQ(field.status, (std::vector{VectorStatus::valid, VectorStatus::valid, VectorStatus::masked}));
  EXPECT_EQ(problem(header + "1 2 3 10 10 10 1 2 3 4\n"), "damaged at bad.csv") << "values are missing";
  EXPECT_EQ(problem(header + "1 2 3 10 word 10 1 2 3 4\n"), "syntax at bad.csv:3");
  EXPECT_EQ(problem("VARIABLES = x, y, u, v\nZONE I=2, F=BLOCK, VARLOCATION=([3]=CELLCENTERED)\n1 2\n"),
            "unsupported at bad.csv:2");
}

TEST_F(VectorFiles, UnusedColumnsAreNamed) {
  VectorFile const back = read_vectors(write("n.csv", "x [px],y [px],u,v,snr,x [mm],good\n1,1,2,2,5,3,1\n"));
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_THAT(back.notes[0], AllOf(HasSubstr("n.csv:1: "), HasSubstr("snr, good")));
  EXPECT_TRUE(back.warnings.empty());
}

// A comma is a decimal comma if another character separates the fields, and otherwise the separator.
TEST_F(VectorFiles, DecimalsMayHaveCommas) {
  for (char const* text :
       {"x;y;u;v\n1,5;2;3,25;-4,5\n", "x\ty\tu\tv\n1,5\t2\t3,25\t-4,5\n", "x y u v\n1,5 2 3,25 -4,5\n",
        "x,y,u,v\n1.5, 2, 3.25, -4.5\n", "x,y,u,v\n\"1,5\",\"2\",\"3,25\",\"-4,5\"\n",
        "\"x\";\"y\";\"u\";\"v\"\n\"1,5\";\"2\";3,25;\"-4,5\"\n", "x;y;u;v\n1.5;2;3.25;-4.5\n"}) {
    VectorFile const back = read_vectors(write("n.csv", text));
    EXPECT_EQ(back.field.position_px[0], (Vec2d{1.5, 2.0})) << text;
    EXPECT_EQ(back.field.displacement_px[0], (Vec2d{3.25, -4.5})) << text;
  }
}

TEST_F(VectorFiles, CommasThatSeparateAndMarkDecimalsAreRefusedWithTheirLine) {
  auto const reading = [&](std::string const& text) { return [this, text] { read_vectors(write("bad.csv", text)); }; };
  EXPECT_THAT(reading("x,y,u,v\n11,500,11,500,-0,901,0,845\n"), ThrowsDataError(ErrorCode::syntax, "bad.csv:2"));
  EXPECT_THAT(reading("x,y,u,v\n11.5,11,-0.9,0.8,7\n"), ThrowsDataError(ErrorCode::syntax, "bad.csv:2"));
  EXPECT_TRUE(has_ambiguous_commas("11,500,11,500,-0,901,0,845", 4));
  EXPECT_FALSE(has_ambiguous_commas("11.5,11,-0.9,0.8,7", 4));
}

// A text is read in UTF-8 and in UTF-16 of both byte orders; UTF-16 without a byte order mark is rejected by its name.
TEST_F(VectorFiles, Utf16IsRead) {
  std::string const text = "x,y,u,v\r\n1.5,2,3.25,-4.5\r\n";
  std::string little, big;
  for (char const c : text) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  for (std::string const& bytes : {"\xff\xfe" + little, "\xfe\xff" + big}) {
    VectorFile const back = read_vectors(write("u.csv", bytes));
    ASSERT_EQ(back.field.size(), 1u);
    EXPECT_EQ(back.field.position_px[0], (Vec2d{1.5, 2.0}));
    EXPECT_EQ(back.field.displacement_px[0], (Vec2d{3.25, -4.5}));
  }
  EXPECT_EQ(problem(little), "wrong_format at bad.csv");
  EXPECT_EQ(problem(big), "wrong_format at bad.csv");
}

TEST_F(VectorFiles, NamedColumnsAreReadInAnyOrder) {
  VectorFile const back = read_vectors(write("n.csv", "v;su;u;y;x;sv\n4;0.1;3;2;1;0.2\n"));
  EXPECT_EQ(back.format, "named columns");
  EXPECT_EQ(back.field.position_px[0], (Vec2d{1.0, 2.0}));
  EXPECT_EQ(back.field.displacement_px[0], (Vec2d{3.0, 4.0}));
  EXPECT_EQ(back.field.sigma_px[0], (Vec2d{0.1, 0.2}));
}

// A number beyond the range of double is still a number: its vector is excluded, and the file is not rejected.
TEST_F(VectorFiles, NumbersBeyondDoublesAreInfinite) {
  VectorFile const back = read_vectors(write("n.csv", "x,y,u,v\n1e400,-1e400,1e-400,inf\n"));
  double const infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(back.field.position_px[0], (Vec2d{infinity, -infinity}));
  EXPECT_EQ(back.field.displacement_px[0], (Vec2d{0.0, infinity}));
}

TEST_F(VectorFiles, BrokenTextIsRefusedAtItsLine) {
  EXPECT_EQ(problem(""), "missing_content at bad.csv:1");
  EXPECT_EQ(problem("x,y,u,v\n"), "missing_content at bad.csv:1");
  EXPECT_EQ(problem("1,2,3,4\n"), "missing_content at bad.csv:1");
  EXPECT_EQ(problem("x,y,u\n1,2,3\n"), "missing_content at bad.csv:1");
  EXPECT_EQ(problem("x,y,u,v\n1,2,3,4\n1,2,3\n"), "syntax at bad.csv:3");
  EXPECT_EQ(problem("x,y,u,v\n1,2,3,4\n\n1,2,3,4x\n"), "syntax at bad.csv:4");
  EXPECT_EQ(problem("x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status\n1,2,3,4,nan,nan,nan,7\n"),
            "out_of_range at bad.csv:2");
  EXPECT_EQ(problem("x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status,u_raw_px,v_raw_px,correlation,reason,"
                    "ambiguous\n1,2,3,4,nan,nan,nan,0,3,4,0.5,9,0\n"),
            "out_of_range at bad.csv:2");
  EXPECT_THAT([&] { read_vectors(in_folder("absent.csv")); }, ThrowsDataError(ErrorCode::missing_file, "absent.csv"));
  EXPECT_THAT([&] { read_vectors(in_folder("absent.h5")); }, ThrowsDataError(ErrorCode::missing_file, "absent.h5"));
}

TEST(VectorConventions, AreParsedAndDescribedInTheSameWords) {
  VectorConventions const told =
      parse_conventions("y-up, v-up,offset=-0.5,frames-exchanged,axes-exchanged,px=0.0614,px/frame=6.14");
  EXPECT_EQ(parse_conventions("swapped"), parse_conventions("frames-exchanged"));
  EXPECT_TRUE(told.exchanges_places() && told.exchanges_components());
  EXPECT_TRUE(told.y_up && told.v_up && told.swapped);
  EXPECT_EQ(told.offset_px, -0.5);
  EXPECT_EQ(parse_conventions(describe(told)), told);
  EXPECT_EQ(parse_conventions("y-up-image").mirror, VectorConventions::Mirror::image);
  EXPECT_EQ(error_of([] { parse_conventions("y-sideways"); }), "arguments at --conventions");
  EXPECT_EQ(error_of([] { parse_conventions("offset=half"); }), "arguments at --conventions");
  EXPECT_EQ(error_of([] { parse_conventions("px=0"); }), "arguments at --conventions");
}

}  // namespace
}  // namespace gladstone
