// Fields in the formats of NumPy and MATLAB and in tables of points. The files are built byte by byte from the formats'
// specifications.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>

#include "render/base/error.h"
#include "render/files/fields/field_file.h"
#include "render/files/hdf5_file.h"
#include "tests/support/documented_tables.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"
#include "tests/support/folder_fixture.h"
#include "tests/support/number_bytes.h"

namespace gladstone::array_readers_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class ArrayReaders : public FolderFixture {
 protected:
  static std::vector<double> values_of(std::string const& path, std::string const& dataset = "", int values = 1) {
    auto const source = open_field(path, dataset, values);
    std::vector<double> read(source->grid().size() * static_cast<std::size_t>(values));
    source->read_planes(0, source->grid().nodes[2], read);
    return read;
  }
  /// Returns code and place of the error when a file is opened and read.
  static std::string refusal(std::string const& path, std::string const& dataset = "", int values = 1) {
    try {
      values_of(path, dataset, values);
    } catch (DataError const& error) {
      return code_and_place(error);
    }
    return "no error";
  }
};

/// Returns 100 z + 10 y + x at each node of 4 x 3 x 2 nodes, x fastest.
std::vector<double> numbered() {
  std::vector<double> values;
  for (int z = 0; z < 2; ++z) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 4; ++x) values.push_back(100.0 * z + 10.0 * y + x);
    }
  }
  return values;
}

template <class Stored>
std::string number(std::uint64_t value, bool big_endian = false) {
  return bytes<Stored>({static_cast<double>(value)}, big_endian);
}

/// Returns a file of numpy.save(). Format: NumPy, numpy.lib.format.
std::string npy(std::string const& descr, std::string const& shape, std::string const& data, bool fortran = false,
                int version = 1) {
  std::string const header =
      "{'descr': " + descr + ", 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }\n";
  std::string const length = version == 1 ? number<std::uint16_t>(header.size()) : number<std::uint32_t>(header.size());
  return "\x93NUMPY" + std::string(1, static_cast<char>(version)) + std::string(1, '\0') + length + header + data;
}

using NpyField = ArrayReaders;

TEST_F(NpyField, TypesAndByteOrdersAreRead) {
  auto const values = numbered();
  std::string const shape = "(2, 3, 4)";
  EXPECT_EQ(values_of(write("a.npy", npy("'<f4'", shape, bytes<float>(values)))), values);
  EXPECT_EQ(values_of(write("b.npy", npy("'>f4'", shape, bytes<float>(values, true)))), values);
  EXPECT_EQ(values_of(write("c.npy", npy("'<f8'", shape, bytes<double>(values)))), values);
  EXPECT_EQ(values_of(write("d.npy", npy("'>i2'", shape, bytes<std::int16_t>(values, true)))), values);
  EXPECT_EQ(values_of(write("e.npy", npy("'|u1'", shape, bytes<std::uint8_t>(values)))), values);
  EXPECT_EQ(values_of(write("f.npy", npy("'<u8'", shape, bytes<std::uint64_t>(values)))), values);
}

// binary16: 0x3C00 = 1, 0xC100 = -2.5, 0x0001 = 2^-24, 0x7BFF = 65504
TEST_F(NpyField, HalfPrecisionIsRead) {
  std::string const data = number<std::uint16_t>(0x3C00) + number<std::uint16_t>(0xC100) +
                           number<std::uint16_t>(0x0001) + number<std::uint16_t>(0x7BFF);
  EXPECT_THAT(values_of(write("h.npy", npy("'<f2'", "(2, 2)", data))), ElementsAre(1, -2.5, 0x1p-24, 65504));
}

TEST_F(NpyField, EveryVersionIsRead) {
  for (int const version : {1, 2, 3})
    EXPECT_EQ(values_of(write("v.npy", npy("'<f8'", "(2, 3, 4)", bytes<double>(numbered()), false, version))),
              numbered());
}

// In Fortran order the first index of [z, y, x] varies fastest.
TEST_F(NpyField, FortranOrderHasTheSameIndices) {
  std::vector<double> stored;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 2; ++z) stored.push_back(100.0 * z + 10.0 * y + x);
    }
  }
  auto const path = write("f.npy", npy("'<f4'", "(2, 3, 4)", bytes<float>(stored), true));
  EXPECT_THAT(open_field(path, "")->grid().nodes, ElementsAre(4, 3, 2));
  EXPECT_EQ(values_of(path), numbered());
}

TEST_F(NpyField, PlanesAndRowsAreReadAlone) {
  auto const source = open_field(write("a.npy", npy("'<f4'", "(2, 3, 4)", bytes<float>(numbered()))), "");
  std::vector<double> plane(12), row(4);
  source->read_planes(1, 1, plane);
  EXPECT_THAT(plane, ElementsAre(100, 101, 102, 103, 110, 111, 112, 113, 120, 121, 122, 123));
  source->read_rows(1, 2, 1, row);
  EXPECT_THAT(row, ElementsAre(120, 121, 122, 123));
}

TEST_F(NpyField, UnknownSpacingIsReported) {
  auto const source = open_field(write("a.npy", npy("'<f4'", "(2, 3, 4)", bytes<float>(numbered()))), "");
  EXPECT_FALSE(source->units().spaced);
  EXPECT_NE(source->units().assumed(), "");
  EXPECT_EQ(source->significant_bits(), 24);
}

TEST_F(NpyField, VelocitiesHaveThreeComponents) {
  std::vector<double> values(72);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i);
  EXPECT_EQ(values_of(write("v.npy", npy("'<f8'", "(2, 3, 4, 3)", bytes<double>(values))), "", 3), values);
}

TEST_F(NpyField, OtherContentIsNamed) {
  std::string const data = bytes<double>(numbered());
  EXPECT_EQ(refusal(write("o.npy", npy("'|O'", "(2, 3, 4)", data))), "wrong_type at o.npy");
  EXPECT_EQ(refusal(write("c.npy", npy("'<c16'", "(2, 2, 3)", data))), "wrong_type at c.npy");
  EXPECT_EQ(refusal(write("r.npy", npy("[('x', '<f8')]", "(2, 3, 4)", data))), "wrong_type at r.npy");
  EXPECT_EQ(refusal(write("s.npy", npy("'<U2'", "(2, 3, 4)", data))), "wrong_type at s.npy");
  EXPECT_EQ(refusal(write("g.npy", npy("'<f16'", "(2, 2, 3)", data))), "wrong_type at g.npy");
  EXPECT_EQ(refusal(write("n.npy", npy("'<f8'", "(2, 3, 4)", data)), "rho"), "missing_content at n.npy");
  EXPECT_EQ(refusal(write("l.npy", npy("'<f8'", "(24,)", data))), "missing_content at l.npy");
}

TEST_F(NpyField, DamagedFilesAreRefused) {
  std::string const good = npy("'<f8'", "(2, 3, 4)", bytes<double>(numbered()));
  EXPECT_EQ(refusal(write("m.npy", "NUMPY" + good)), "wrong_format at m.npy");
  EXPECT_EQ(refusal(write("e.npy", "")), "wrong_format at e.npy");
  EXPECT_EQ(refusal(write("t.npy", good.substr(0, good.size() - 8))), "damaged at t.npy");
  EXPECT_EQ(refusal(write("x.npy", good + "12345678")), "damaged at x.npy");
  EXPECT_EQ(refusal(write("h.npy", good.substr(0, 30))), "damaged at h.npy");
  EXPECT_EQ(refusal(write("v.npy", npy("'<f8'", "(2, 3, 4)", "", false, 9))), "unsupported at v.npy");
  EXPECT_EQ(refusal(write("d.npy", npy("<f8", "(2, 3, 4)", ""))), "damaged at d.npy");
  EXPECT_EQ(refusal(write("s.npy", npy("'<f8'", "(2, -3)", ""))), "damaged at s.npy");
  // sizes beyond the file and beyond any memory
  EXPECT_EQ(refusal(write("l.npy", npy("'<f8'", "(4000000, 4000000, 4000000)", ""))), "damaged at l.npy");
  EXPECT_EQ(refusal(write("g.npy", npy("'<f8'", "(10000, 10000, 1000)", ""))), "damaged at g.npy");
  EXPECT_EQ(refusal(write("k.npy", "\x93NUMPY\x02" + std::string(1, '\0') + "\xff\xff\xff\x7f{'descr'")),
            "damaged at k.npy");
}

/// Builder of zip archives (PKWARE APPNOTE.TXT): local headers with their data, the directory, and its end.
class Zip {
 public:
  /// @param kept  number of bytes of the content that the compressed data contain; the headers declare all
  void add(std::string const& name, std::string const& content, bool deflated, bool good_checksum = true,
           std::size_t kept = std::string::npos) {
    std::string const data = deflated ? deflate_raw(content.substr(0, kept)) : content;
    auto crc = static_cast<std::uint32_t>(
        crc32(0, reinterpret_cast<Bytef const*>(content.data()), static_cast<uInt>(content.size())));
    if (!good_checksum) ++crc;
    std::string const common = number<std::uint16_t>(deflated ? 8 : 0) + number<std::uint32_t>(0) +
                               number<std::uint32_t>(crc) + number<std::uint32_t>(data.size()) +
                               number<std::uint32_t>(content.size()) + number<std::uint16_t>(name.size()) +
                               number<std::uint16_t>(0);
    directory_ += "PK\x01\x02" + number<std::uint16_t>(20) + number<std::uint16_t>(20) + number<std::uint16_t>(0) +
                  common + std::string(10, '\0') + number<std::uint32_t>(content_.size()) + name;
    content_ += "PK\x03\x04" + number<std::uint16_t>(20) + number<std::uint16_t>(0) + common + name + data;
    ++entries_;
  }
  std::string archive() const {
    return content_ + directory_ + "PK\x05\x06" + number<std::uint32_t>(0) + number<std::uint16_t>(entries_) +
           number<std::uint16_t>(entries_) + number<std::uint32_t>(directory_.size()) +
           number<std::uint32_t>(content_.size()) + number<std::uint16_t>(0);
  }

 private:
  static std::string deflate_raw(std::string const& content) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, static_cast<uLong>(content.size())), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    stream.avail_in = static_cast<uInt>(content.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
  }

  std::string content_, directory_;
  std::uint64_t entries_ = 0;
};

using NpzField = ArrayReaders;

TEST_F(NpzField, StoredAndDeflatedArraysHaveTheirCoordinates) {
  for (bool const deflated : {false, true}) {
    Zip zip;
    zip.add("rho.npy", npy("'<f4'", "(2, 3, 4)", bytes<float>(numbered())), deflated);
    zip.add("x_mm.npy", npy("'<f8'", "(4,)", bytes<double>({1, 1.5, 2, 2.5})), deflated);
    zip.add("y_mm.npy", npy("'<f8'", "(3,)", bytes<double>({0, 2, 4})), deflated);
    zip.add("z_mm.npy", npy("'<f8'", "(2,)", bytes<double>({-1, 1})), deflated);
    zip.add("names.npy", npy("'|O'", "(1,)", "pickle"), deflated);
    std::string const name = deflated ? "c.npz" : "s.npz", path = write(name, zip.archive());
    auto const source = open_field(path, "");
    EXPECT_EQ(source->name(), "rho");
    EXPECT_EQ(source->units().length, "mm");
    EXPECT_EQ(source->grid().spacing.x, 0.5);
    EXPECT_EQ(source->grid().spacing.y, 2.0);
    EXPECT_EQ(source->grid().origin.z, -1.0);
    EXPECT_EQ(values_of(path), numbered());
    EXPECT_EQ(refusal(path, "names"), "wrong_type at " + name);
    EXPECT_EQ(refusal(path, "rh"), "missing_content at " + name);
  }
}

TEST_F(NpzField, DamagedArchivesAreRefused) {
  Zip zip, wrong;
  std::string const array = npy("'<f8'", "(2, 3, 4)", bytes<double>(numbered()));
  zip.add("rho.npy", array, true);
  std::string const good = zip.archive();
  EXPECT_EQ(refusal(write("m.npz", "not a zip archive")), "wrong_format at m.npz");
  EXPECT_EQ(refusal(write("t.npz", good.substr(0, good.size() - 30))), "damaged at t.npz");
  wrong.add("rho.npy", array, true, false);
  EXPECT_EQ(refusal(write("c.npz", wrong.archive())), "damaged at c.npz");
  Zip stored;
  stored.add("rho.npy", array, false, false);
  EXPECT_EQ(refusal(write("stored.npz", stored.archive())), "damaged at stored.npz");
  Zip early;  // compressed data that end before the array does, in an archive of full length
  early.add("rho.npy", array, true, true, array.size() - 16);
  EXPECT_EQ(refusal(write("early.npz", early.archive())), "damaged at early.npz");
  std::string crossed = good;
  crossed.replace(crossed.rfind("PK\x05\x06") + 16, 4, "\xff\xff\xff\x7f");  // the directory beyond the file
  EXPECT_EQ(refusal(write("o.npz", crossed)), "damaged at o.npz");
  Zip large;
  large.add("rho.npy", npy("'<f8'", "(10000, 10000, 1000)", "12345678"), true);
  EXPECT_EQ(refusal(write("l.npz", large.archive())), "damaged at l.npz");
}

/// Data element of a MAT-file (MathWorks, MAT-File Format): tag, data, padding to 8 bytes.
std::string element(std::uint32_t type, std::string const& data, bool big = false) {
  return number<std::uint32_t>(type, big) + number<std::uint32_t>(data.size(), big) + data +
         std::string((8 - data.size() % 8) % 8, '\0');
}

/// Matrix of a class with its numbers stored as a type.
std::string matrix(std::string const& name, std::vector<double> const& sizes, std::uint32_t type,
                   std::string const& data, bool big = false, std::uint32_t flags = 6) {
  return element(14,
                 element(6, number<std::uint32_t>(flags, big) + number<std::uint32_t>(0, big), big) +
                     element(5, bytes<std::int32_t>(sizes, big), big) + element(1, name, big) +
                     element(type, data, big),
                 big);
}

std::string mat(std::string const& elements, bool big = false) {
  std::string header = "MATLAB 5.0 MAT-file, test";
  header.resize(124, ' ');
  return header + number<std::uint16_t>(0x0100, big) + (big ? "MI" : "IM") + elements;
}

std::string zlib_element(std::string const& content) {
  std::string out(compressBound(static_cast<uLong>(content.size())), '\0');
  auto size = static_cast<uLongf>(out.size());
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<Bytef const*>(content.data()),
           static_cast<uLong>(content.size()));
  out.resize(size);
  return number<std::uint32_t>(15) + number<std::uint32_t>(out.size()) + out;
}

using MatField = ArrayReaders;

// ndgrid: [nx, ny, nz], the first index varies fastest
TEST_F(MatField, ArraysOfEitherByteOrderAreRead) {
  for (bool const big : {false, true}) {
    auto const path =
        write(big ? "b.mat" : "l.mat", mat(matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered(), big), big), big));
    EXPECT_THAT(open_field(path, "")->grid().nodes, ElementsAre(4, 3, 2));
    EXPECT_EQ(values_of(path), numbered());
  }
}

TEST_F(MatField, CompressedArraysHaveTheirCoordinates) {
  std::string const path = write("c.mat", mat(zlib_element(matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered()))) +
                                              zlib_element(matrix("x_mm", {1, 4}, 9, bytes<double>({1, 1.5, 2, 2.5}))) +
                                              zlib_element(matrix("y_mm", {3, 1}, 9, bytes<double>({0, 2, 4}))) +
                                              zlib_element(matrix("z_mm", {1, 2}, 9, bytes<double>({-1, 1})))));
  auto const source = open_field(path, "");
  EXPECT_EQ(source->name(), "rho");
  EXPECT_EQ(source->grid().spacing.x, 0.5);
  EXPECT_EQ(source->grid().spacing.y, 2.0);
  EXPECT_EQ(source->grid().origin.z, -1.0);
  EXPECT_TRUE(source->notes().empty());
  EXPECT_EQ(values_of(path), numbered());
}

// MATLAB stores doubles that are small integers as integers; single precision is type 7 of class 7.
TEST_F(MatField, NumbersOfOtherTypesAreRead) {
  EXPECT_EQ(values_of(write("i.mat", mat(matrix("rho", {4, 3, 2}, 2, bytes<std::uint8_t>(numbered()))))), numbered());
  auto const path = write("s.mat", mat(matrix("rho", {4, 3, 2}, 7, bytes<float>(numbered()), false, 7)));
  EXPECT_EQ(open_field(path, "")->significant_bits(), 24);
  EXPECT_EQ(values_of(path), numbered());
}

// Without coordinates ndgrid and meshgrid cannot be distinguished.
TEST_F(MatField, OrderOfTheAxesIsReported) {
  auto const source = open_field(write("n.mat", mat(matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered())))), "");
  ASSERT_FALSE(source->notes().empty());
  EXPECT_THAT(source->notes()[0], Warns("assumed"));
}

TEST_F(MatField, OtherVariablesAreNamed) {
  std::string const rho = matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered()));
  auto const path = write("o.mat", mat(matrix("title", {1, 2}, 4, "a\0b\0", false, 4) + rho +
                                       matrix("wave", {1, 1}, 9, bytes<double>({1}), false, 6 | 0x0800)));
  EXPECT_EQ(values_of(path), numbered());
  EXPECT_EQ(refusal(path, "title"), "wrong_type at o.mat");
  EXPECT_EQ(refusal(path, "wave"), "wrong_type at o.mat");
  EXPECT_EQ(refusal(path, "density"), "missing_content at o.mat");
}

TEST_F(MatField, DamagedFilesAreRefused) {
  std::string const good = mat(matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered())));
  EXPECT_EQ(refusal(write("t.mat", good.substr(0, good.size() - 8))), "damaged at t.mat");
  EXPECT_EQ(refusal(write("h.mat", good.substr(0, 100))), "damaged at h.mat");
  EXPECT_EQ(refusal(write("g.mat", good.substr(0, 132))), "damaged at g.mat");
  EXPECT_EQ(refusal(write("w.mat", "MATLAB" + good)), "wrong_format at w.mat");
  // sizes beyond the data, also in compressed data
  std::string const large = matrix("rho", {40000, 30000, 200}, 9, bytes<double>(numbered()));
  EXPECT_EQ(refusal(write("s.mat", mat(large))), "damaged at s.mat");
  EXPECT_EQ(refusal(write("z.mat", mat(zlib_element(large)))), "damaged at z.mat");
  std::string broken = mat(zlib_element(matrix("rho", {4, 3, 2}, 9, bytes<double>(numbered()))));
  broken[128 + 8] = '\xff';  // first byte of zlib's header
  EXPECT_EQ(refusal(write("b.mat", broken)), "damaged at b.mat");
}

// MATLAB 7.3 is HDF5.
TEST_F(MatField, Hdf5IsRead) {
  std::string const path = write("h.mat", "");
  fs::remove(path);
  Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
  writer.write("rho", std::span<double const>(numbered()), {2, 3, 4}, "kg/m^3", "density", "z, y, x");
  writer.close();
  EXPECT_EQ(values_of(path), numbered());
}

/// Returns lines "x,y,z,100 z + 10 y + x" of 4 x 3 x 2 points, from the last to the first.
std::string reversed_points(std::string const& separator) {
  std::string text;
  auto const values = numbered();
  for (std::size_t i = values.size(); i-- > 0;) {
    text += std::to_string(0.5 * static_cast<double>(i % 4)) + separator + std::to_string(2 * (i / 4 % 3)) + separator +
            std::to_string(i / 12) + separator + std::to_string(values[i]) + '\n';
  }
  return text;
}

using PointTableField = ArrayReaders;

TEST_F(PointTableField, PointsInAnyOrderAreAGrid) {
  for (std::string const separator : {",", ";", "\t", " "}) {
    std::string const header = "x_mm" + separator + "y_mm" + separator + "z_mm" + separator + "rho\n";
    auto const path = write("p.csv", header + reversed_points(separator));
    auto const source = open_field(path, "");
    EXPECT_EQ(source->name(), "rho");
    EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
    EXPECT_EQ(source->grid().spacing.x, 0.5);
    EXPECT_EQ(source->grid().spacing.y, 2.0);
    EXPECT_EQ(source->units().length, "mm");
    EXPECT_EQ(values_of(path), numbered()) << separator;
  }
}

// A comma within a field is a decimal comma.
TEST_F(PointTableField, DecimalCommasAreRead) {
  std::string points = reversed_points(";");
  std::replace(points.begin(), points.end(), '.', ',');
  auto const path = write("p.csv", "x_mm;y_mm;z_mm;rho\n" + points);
  EXPECT_EQ(open_field(path, "")->grid().spacing.x, 0.5);
  EXPECT_EQ(values_of(path), numbered());
  EXPECT_THAT(values_of(write("q.csv", "x,y,rho\n\"0,0\",0,\"1,5\"\n\"0,5\",0,2\n\"0,0\",1,3\n\"0,5\",1,4\n")),
              ElementsAre(1.5, 2, 3, 4));
  EXPECT_EQ(refusal(write("t.csv", "x;y;rho\n0;0;1,000,5\n")), "syntax at t.csv:2");
}

TEST_F(PointTableField, UnitsAreInBrackets) {
  auto const source =
      open_field(write("p.txt", "# x [cm], y [cm], z [cm], rho [g/cm^3]\n" + reversed_points(",")), "rho");
  EXPECT_EQ(source->units().length, "cm");
  EXPECT_EQ(source->units().values, "g/cm^3");
}

TEST_F(PointTableField, UnitsAreAtTheEndsOfNames) {
  auto const source = open_field(write("p.csv", "x_mm,y_mm,z_mm,rho_kg_m3\n" + reversed_points(",")), "rho_kg_m3");
  EXPECT_EQ(source->units().length, "mm");
  EXPECT_EQ(source->units().values, "kg/m^3");
  EXPECT_EQ(unit_suffix("Vx_mm_s").unit, "mm/s");
  EXPECT_EQ(unit_suffix("_m_s").unit, "") << "is a name without a quantity";
  auto const velocity = open_field(
      write("v.csv", "x_mm,y_mm,u_m_s,v_m_s,w_m_s\n0,0,1,2,3\n1,0,4,5,6\n0,1,7,8,9\n1,1,10,11,12\n"), "velocity", 3);
  EXPECT_EQ(velocity->units().values, "m/s");
}

TEST_F(PointTableField, TecplotPointZonesAreRead) {
  std::string const header =
      "TITLE = \"density, plane\"\nVARIABLES = \"X [mm]\", \"Y [mm]\"\n\"Z [mm]\"\n\"rho\"\n"
      "ZONE T=\"a\", I=4, J=3, K=2, DATAPACKING=POINT\n";
  auto const path = write("p.dat", header + reversed_points(" "));
  EXPECT_EQ(values_of(path), numbered());
  EXPECT_EQ(open_field(path, "")->units().length, "mm");
  auto const two = write("two.dat", header + reversed_points(" ") + "ZONE T=\"b\"\n1 2 3 4\n");
  EXPECT_THAT(open_field(two, "")->notes(), testing::Contains(Warns("ignored at two.dat:30")));
}

TEST_F(PointTableField, TecplotBlockZonesAreRead) {
  std::string const header = "VARIABLES = x, y, rho\nZONE I=2, J=2, F=BLOCK\n";
  EXPECT_THAT(values_of(write("b.dat", header + "0 1 0 1\n0 0 1\n1 1 2 3 4\n")), ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(refusal(write("s.dat", header + "0 1 0 1\n0 0 1 1\n1 2 3\n")), "damaged at s.dat");
  EXPECT_EQ(refusal(write("c.dat", "VARIABLES = x, y, rho\nZONE I=2, F=BLOCK, VARLOCATION=([3]=CELLCENTERED)\n0 1\n")),
            "unsupported at c.dat:3");
}

TEST_F(PointTableField, PlanesHaveTwoCoordinates) {
  auto const path = write("p.csv", "y,x,rho\n1,10,3\n0,10,1\n0,12,2\n1,12,4\n");
  EXPECT_THAT(open_field(path, "")->grid().nodes, ElementsAre(2, 2, 1));
  EXPECT_THAT(values_of(path), ElementsAre(1, 2, 3, 4));
}

TEST_F(PointTableField, ThreeColumnsAreAVelocity) {
  auto const path = write("p.csv", "x,y,u,v,w\n0,0,1,2,3\n1,0,4,5,6\n0,1,7,8,9\n1,1,10,11,12\n");
  EXPECT_THAT(values_of(path, "", 3), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  EXPECT_EQ(open_field(path, "", 3)->name(), "velocity");
  EXPECT_THAT(values_of(path, "v"), ElementsAre(2, 5, 8, 11));
}

// Components of one group and of equal shape are the last axis of a velocity, whichever format stores them. A plane of
// planar PIV has two.
TEST_F(ArrayReaders, ComponentsInSeparateArraysAreAVelocity) {
  std::vector<double> const u = numbered();
  std::vector<double> v(u), both;
  for (double& value : v) value = -2 * value;
  for (std::size_t i = 0; i < u.size(); ++i) both.insert(both.end(), {u[i], v[i], 0.5});
  std::vector<double> const w(u.size(), 0.5);
  auto const expect_read = [&](std::string const& path, std::string const& name, std::string const& unit) {
    auto const source = open_field(path, "", 3);
    EXPECT_EQ(source->name(), name);
    EXPECT_EQ(source->units().values, unit);
    EXPECT_THAT(source->grid().nodes, ElementsAre(4, 3, 2));
    // a note on the order of axes names the shape, with three components
    EXPECT_THAT(source->notes(), testing::Each(testing::Field(&Warning::text, HasSubstr("[2, 3, 4, 3]"))));
    EXPECT_EQ(values_of(path, "", 3), both);
    EXPECT_EQ(values_of(path, "", 3), values_of(path, name, 3));
  };
  expect_read(write("three.mat", mat(matrix("Vx_m_s", {4, 3, 2}, 9, bytes<double>(u)) +
                                     matrix("Vy_m_s", {4, 3, 2}, 9, bytes<double>(v)) +
                                     matrix("Vz_m_s", {4, 3, 2}, 9, bytes<double>(w)))),
              "velocity", "m/s");

  std::string const path = write("three.h5", "");
  fs::remove(path);
  Hdf5Writer writer(path, {"test", 1, "", 0, "cpu"});
  std::vector<double> const x{0, 0.5, 1, 1.5}, y{0, 2, 4}, z{0, 3};
  writer.write("flow/x", std::span<double const>(x), {4}, "mm", "", "x");
  writer.write("flow/y", std::span<double const>(y), {3}, "mm", "", "y");
  writer.write("flow/z", std::span<double const>(z), {2}, "mm", "", "z");
  for (auto const& [name, values] : {std::pair{"flow/u", &u}, {"flow/v", &v}, {"flow/w", &w}})
    writer.write(name, std::span<double const>(*values), {2, 3, 4}, "mm/s", "", "z, y, x");
  writer.write("flow/p", std::span<double const>(u), {2, 3, 4}, "Pa", "", "z, y, x");
  writer.attach_scales({{"/flow/u", {"/flow/z", "/flow/y", "/flow/x"}}});
  writer.close();
  expect_read(path, "flow/velocity", "mm/s");
  EXPECT_EQ(open_field(path, "", 3)->grid().spacing, (Vec3d{0.5, 2, 3}));

  std::string const plane = write("plane.csv", "x,y,u,v\n0,0,1,2\n1,0,4,5\n0,1,7,8\n1,1,10,11\n");
  EXPECT_THAT(values_of(plane, "", 3), ElementsAre(1, 2, 0, 4, 5, 0, 7, 8, 0, 10, 11, 0));
  EXPECT_THAT(open_field(plane, "", 3)->notes(), ElementsAre(Warns("assumed")));
}

// Single arrays and arrays of different shapes are not components of a velocity. Components in different units are
// rejected, since the numbers alone do not show the units.
TEST_F(ArrayReaders, ArraysThatAreNoVelocityAreRefused) {
  auto const two = [&](std::string const& second, std::vector<double> const& sizes) {
    return write("two.mat", mat(matrix("u_m_s", {4, 3, 2}, 9, bytes<double>(numbered())) +
                                matrix(second, sizes, 9, bytes<double>(numbered()))));
  };
  EXPECT_EQ(refusal(two("v_m_s", {6, 4, 1}), "", 3), "missing_content at two.mat");
  EXPECT_EQ(refusal(two("w_m_s", {4, 3, 2}), "", 3), "missing_content at two.mat");
  EXPECT_EQ(refusal(two("v_mm_s", {4, 3, 2}), "", 3), "inconsistent at two.mat");
}

TEST_F(PointTableField, MissingAndRepeatedPointsAreNamed) {
  EXPECT_THAT([&] { values_of(write("m.csv", "x,y,rho\n0,0,1\n2,0,2\n0,3,4\n")); },
              ThrowsDataError(ErrorCode::missing_content, "m.csv", HasSubstr("x = 2, y = 3")));
  EXPECT_THAT([&] { values_of(write("g.csv", "x,y,rho\n0,0,1\n0,3,4\n2,3,2\n")); },
              ThrowsDataError(ErrorCode::missing_content, "g.csv", HasSubstr("x = 2, y = 0")));
  EXPECT_EQ(refusal(write("d.csv", "x,y,rho\n0,0,1\n2,0,2\n0,3,4\n2,3,5\n2,0,2\n")), "invalid_value at d.csv:6");
  std::string scattered = "x,y,z,rho\n";
  for (int i = 0; i < 1000; ++i)
    scattered += std::to_string(i * 1.37) + ',' + std::to_string(i * i * 0.11) + ',' + std::to_string(i * 0.7) + ",1\n";
  EXPECT_EQ(refusal(write("s.csv", scattered)), "missing_content at s.csv");
}

TEST_F(PointTableField, OtherTablesAreRefused) {
  EXPECT_EQ(refusal(write("e.csv", "")), "missing_content at e.csv");
  EXPECT_EQ(refusal(write("h.csv", "x,y,rho\n")), "missing_content at h.csv");
  EXPECT_EQ(refusal(write("n.csv", "1,2,3\n")), "missing_content at n.csv:1");
  EXPECT_EQ(refusal(write("c.csv", "a,b,rho\n1,2,3\n")), "missing_content at c.csv");
  EXPECT_EQ(refusal(write("f.csv", "x,y,rho\n0,0,1\n1,0\n")), "syntax at f.csv:3");
  EXPECT_EQ(refusal(write("w.csv", "x,y,rho\n0,0,1\n1,0,word\n")), "syntax at w.csv:3");
  EXPECT_EQ(refusal(write("i.csv", "x,y,rho\n0,0,1\nnan,0,1\n")), "invalid_value at i.csv:3");
}

TEST_F(ArrayReaders, DocumentationListsEveryFormat) {
  std::vector<std::string> const endings = field_extensions();
  EXPECT_EQ(test::names_of_first_column(test::documented_table("Fields that are read", "ending")),
            std::set<std::string>(endings.begin(), endings.end()));
}

}  // namespace
}  // namespace gladstone::array_readers_test
