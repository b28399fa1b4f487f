#include "render/files/hdf5_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "render/base/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

using Hdf5 = FolderFixture;

FileOrigin origin() { return {"gladstone test", 3, "schema = 1\n", 18446744073709551615u, "cpu"}; }

std::vector<double> ramp(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = std::sin(0.001 * static_cast<double>(i));
  return values;
}

void write_ramp(std::string const& path, std::size_t rows) {
  Hdf5Writer writer(path, origin());
  writer.write("/group/deeper/ramp", ramp(rows * 3), {rows, 3}, "m", "a ramp", "row, component (x, y, z)");
  writer.close();
}

TEST_F(Hdf5, ReadsTheValuesThatWereWritten) {
  std::string const path = in_folder("a.h5");
  std::vector<double> const values{0.1, -0.0, std::nan(""), std::numeric_limits<double>::infinity(), 5e-324, 1e300};
  std::vector<std::int64_t> const counts{-1, 9007199254740993};
  {
    Hdf5Writer writer(path, origin());
    writer.write("/dots/position_m", values, {3, 2}, "m", "positions", "dot, component");
    writer.write("/counts", counts, {2}, "1", "counts", "dot");
    writer.write("/none", std::span<double const>{}, {0, 2}, "px", "nothing", "dot, component");
    writer.attribute("/dots", "interpolation", "cubic_bspline");
    writer.attribute("/", "sigma", 0.25);
    EXPECT_FALSE(fs::exists(path));
    writer.close();
  }
  Hdf5Reader const reader(path);
  EXPECT_THAT(reader.shape("/dots/position_m"), ElementsAre(3, 2));
  auto const back = reader.read("dots/position_m");
  ASSERT_EQ(back.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_TRUE(back[i] == values[i] || (std::isnan(back[i]) && std::isnan(values[i]))) << i;
  }
  EXPECT_THAT(reader.read_integers("counts"), ElementsAre(-1, 9007199254740993));  // 2^53 + 1 is not a double
  EXPECT_THAT(reader.read("counts"), ElementsAre(-1.0, 9007199254740992.0));
  EXPECT_TRUE(reader.read("/none").empty());
  EXPECT_THAT(reader.dataset_names(), ElementsAre("counts", "none"));
  EXPECT_TRUE(reader.has("/dots/position_m"));
  EXPECT_FALSE(reader.has("/dots"));
  EXPECT_FALSE(reader.has("/rays/status"));
  EXPECT_EQ(reader.attribute("filetype"), "gladstone test");
  EXPECT_EQ(reader.attribute("version"), "3");
  EXPECT_EQ(reader.attribute("setup"), "schema = 1\n");
  EXPECT_EQ(reader.attribute("seed"), "18446744073709551615");
  EXPECT_EQ(reader.attribute("device"), "cpu");
  EXPECT_EQ(reader.attribute("sigma"), "0.25");
  EXPECT_THAT(reader.attribute("date_and_time"), testing::MatchesRegex("....-..-..T..:..:..Z"));
  for (auto const* name : {"software_version", "git_sha1"}) EXPECT_NE(reader.attribute(name), "");
  EXPECT_EQ(reader.attribute("unheard_of"), "");
}

TEST_F(Hdf5, LongSetupsFitIntoTheAttribute) {
  std::string const path = in_folder("long.h5");
  FileOrigin long_origin = origin();
  long_origin.setup = std::string(300000, 'x');  // an ordinary attribute is limited to 64 KiB
  Hdf5Writer(path, long_origin).close();
  EXPECT_EQ(Hdf5Reader(path).attribute("setup"), long_origin.setup);
}

TEST_F(Hdf5, LargeDatasetsAreCompressedAndRowsReadAlone) {
  std::string const path = in_folder("large.h5");
  std::size_t const rows = 100000;
  write_ramp(path, rows);
  EXPECT_LT(fs::file_size(path), rows * 3 * sizeof(double));
  Hdf5Reader const reader(path);
  auto const whole = reader.read("/group/deeper/ramp");
  EXPECT_EQ(whole, ramp(rows * 3));
  std::vector<double> part(6);
  reader.read_rows("/group/deeper/ramp", 70000, 2, part);
  for (std::size_t i = 0; i < part.size(); ++i) EXPECT_EQ(part[i], whole[210000 + i]);
}

TEST_F(Hdf5, EqualInputGivesEqualFilesButForTheDate) {
  write_ramp(in_folder("a.h5"), 10000);
  write_ramp(in_folder("b.h5"), 10000);
  auto const bytes = [&](std::string const& name) {
    std::string const date = Hdf5Reader(in_folder(name)).attribute("date_and_time");
    std::string text = content(in_folder(name));
    auto const at = text.find(date);
    EXPECT_NE(at, std::string::npos);
    return text.erase(at, date.size());
  };
  EXPECT_TRUE(bytes("a.h5") == bytes("b.h5"));
}

// Files of the same structure are made from a common skeleton, of which the latest are retained. Here the structures
// alternate and are more than are retained; names, shapes, texts, scales and the setup belong to a structure, values
// and other attributes do not.
TEST_F(Hdf5, FilesOfOneStructureHaveTheirOwnContent) {
  auto const name = [this](int k) { return in_folder(std::to_string(k) + ".h5"); };
  constexpr int structures = 6, files = 18;
  auto const size = [](int k) { return static_cast<std::size_t>(k % 2 == 0 ? 3 : 9000 + k % structures); };
  for (int k = 0; k < files; ++k) {
    int const structure = k % structures;
    FileOrigin from = origin();
    from.setup = "schema = " + std::to_string(structure);
    Hdf5Writer writer(name(k), from);
    writer.write("/group/value", std::vector<double>(size(k), 0.5 + k), {size(k)}, "m",
                 "of structure " + std::to_string(structure), "row");
    writer.write("/row", std::vector<std::int64_t>(size(k), k), {size(k)}, "1", "rows", "row");
    if (structure > 2) writer.attach_scales({{"/group/value", {"/row"}}});
    writer.attribute("/", "number", std::int64_t{k});
    writer.close();
  }
  for (int k = 0, structure = 0; k < files; ++k, structure = k % structures) {
    Hdf5Reader const reader(name(k));
    EXPECT_EQ(reader.read("/group/value"), std::vector<double>(size(k), 0.5 + k)) << k;
    EXPECT_EQ(reader.read_integers("/row"), std::vector<std::int64_t>(size(k), k)) << k;
    EXPECT_EQ(reader.attribute("setup"), "schema = " + std::to_string(structure));
    EXPECT_EQ(reader.attribute("number"), std::to_string(k));
    EXPECT_EQ(reader.attribute_of("/group/value", "description"), "of structure " + std::to_string(structure));
    EXPECT_THAT(reader.dimension_scales("/group/value"), ElementsAre(structure > 2 ? "/row" : ""));
  }
}

// The mantissas of these numbers in [1, 2) are random: 6.5 of 8 bytes, which are stored, and the others take half a
// byte. In the second half of the other dataset they are constant.
TEST_F(Hdf5, NoiseIsStoredAndTheRestIsCompressed) {
  constexpr std::size_t count = 20000;
  std::vector<double> noise(count);
  std::mt19937_64 engine(3);
  for (double& value : noise) value = std::bit_cast<double>(0x3ff0'0000'0000'0000u | engine() >> 12);
  std::vector<double> half = noise;
  std::fill(half.begin() + count / 2, half.end(), 1.25);
  auto const bytes = [&](std::vector<double> const& values) {
    Hdf5Writer writer(in_folder("noise.h5"), origin());
    writer.write("/values", values, {count}, "1", "values", "row");
    writer.close();
    EXPECT_TRUE(Hdf5Reader(in_folder("noise.h5")).read("/values") == values);
    return static_cast<double>(fs::file_size(in_folder("noise.h5")));
  };
  EXPECT_LT(bytes(noise), 7.1 * count + 16e3);  // 16 kB for everything but the values
  EXPECT_LT(bytes(half), 4.6 * count + 16e3);
}

TEST_F(Hdf5, MissingDatasetIsNamedWithThoseThatExist) {
  write_ramp(in_folder("a.h5"), 1);
  Hdf5Reader const reader(in_folder("a.h5"));
  EXPECT_THAT([&] { reader.read("group/deeper/rump"); },
              ThrowsDataError(ErrorCode::missing_content, "a.h5", HasSubstr("\"group/deeper/ramp\"")));
  EXPECT_THAT([&] { reader.read_integers("group/deeper/ramp"); }, ThrowsDataError(ErrorCode::wrong_type, "a.h5"));
}

TEST_F(Hdf5, RejectsFilesOfOtherFormats) {
  std::ofstream(in_folder("text.h5")) << "not at all";
  EXPECT_THAT([&] { Hdf5Reader reader(in_folder("text.h5")); }, ThrowsDataError(ErrorCode::wrong_format, "text.h5"));
  EXPECT_THAT([&] { Hdf5Reader reader(in_folder("absent.h5")); },
              ThrowsDataError(ErrorCode::missing_file, "absent.h5"));
  EXPECT_THAT([&] { Hdf5Reader reader(folder_.string()); },
              ThrowsDataError(ErrorCode::unreadable_file, folder_.string()));
}

TEST_F(Hdf5, FileCutShortIsSaidToBeDamaged) {
  std::string const path = in_folder("cut.h5");
  write_ramp(path, 10000);
  fs::resize_file(path, fs::file_size(path) / 2);
  EXPECT_THAT([&] { Hdf5Reader reader(path); }, ThrowsDataError(ErrorCode::damaged, "cut.h5"));
}

// A file of 10007 rows written in chunks has 240 kB. The header of a damaged copy declares 2^60 bytes, or 2.4 GB, which
// would fit into the memory of some machines. No compression ratio explains such a short file, so it must be refused
// before memory is allocated.
TEST_F(Hdf5, RejectsHeadersThatDeclareMoreThanTheFileCanContain) {
  std::string const path = in_folder("promise.h5");
  for (std::string const& promised : {std::string("\0\0\0\0\0\0\0\x02", 8), std::string("\0\xe1\xf5\x05\0\0\0\0", 8)}) {
    write_ramp(path, 10007);
    std::string bytes = content(path);
    std::string const rows("\x17\x27\0\0\0\0\0\0", 8);
    int replaced = 0;
    for (std::size_t at; (at = bytes.find(rows)) != std::string::npos; ++replaced) bytes.replace(at, 8, promised);
    ASSERT_GE(replaced, 1);
    std::ofstream(path, std::ios::binary) << bytes;
    Hdf5Reader const reader(path);
    auto const refused = ThrowsDataError(ErrorCode::damaged, "promise.h5", HasSubstr(" x 3 values"));
    EXPECT_THAT([&] { reader.read("/group/deeper/ramp"); }, refused);
    EXPECT_THAT([&] { reader.shape("/group/deeper/ramp"); }, refused);
    std::vector<double> row(3);
    EXPECT_THAT([&] { reader.read_rows("/group/deeper/ramp", 0, 1, row); }, refused);
  }
}

// Datasets of more than 64 KiB are compressed in chunks of at most 1 MiB, whose last ones exceed the dataset along the
// divided axis: 200001 values in chunks of 100001; 301 rows of 4 kB in chunks of 151; 3 x 5 planes of 1.4 MB in chunks
// of half a plane.
TEST_F(Hdf5, ChunksAreReadBack) {
  std::string const path = in_folder("chunks.h5");
  std::vector<std::vector<std::size_t>> const shapes{{8193}, {200001}, {301, 512}, {3, 5, 425, 425}, {2, 1, 131073}};
  Hdf5Writer writer(path, origin());
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    std::size_t count = 1;
    for (std::size_t const size : shapes[k]) count *= size;
    std::vector<double> values = ramp(count);
    std::vector<std::int64_t> integers(count);
    for (std::size_t i = 0; i < count; ++i) integers[i] = static_cast<std::int64_t>(i * i);
    writer.write("/numbers_" + std::to_string(k), values, shapes[k], "1", "numbers", "");
    writer.write("/integers_" + std::to_string(k), integers, shapes[k], "1", "integers", "");
  }
  writer.close();
  Hdf5Reader const reader(path);
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    EXPECT_EQ(reader.shape("/numbers_" + std::to_string(k)), shapes[k]);
    std::vector<double> const values = reader.read("/numbers_" + std::to_string(k));
    EXPECT_TRUE(values == ramp(values.size())) << k;
    std::vector<std::int64_t> const integers = reader.read_integers("/integers_" + std::to_string(k));
    std::size_t wrong = integers.size() == values.size() ? 0 : 1;
    for (std::size_t i = 0; i < integers.size(); ++i) wrong += integers[i] != static_cast<std::int64_t>(i * i);
    EXPECT_EQ(wrong, 0u) << k;
  }
}

// Zeros are compressed to less than a thousandth of their size; 160 MB of them must still be read.
TEST_F(Hdf5, ReadsHighlyCompressedDatasets) {
  std::string const path = in_folder("zeros.h5");
  std::size_t const count = 20'000'000;
  Hdf5Writer writer(path, origin(), Hdf5Growth::on_disk);
  writer.make_rows<double>("/zeros", {count}, {1'000'000}, "1", "zeros", "row");
  writer.write_rows<double>("/zeros", 0, std::vector<double>(count));
  writer.close();
  EXPECT_LT(fs::file_size(path), count * sizeof(double) / 500);
  EXPECT_EQ(Hdf5Reader(path).read("/zeros").size(), count);
}

TEST_F(Hdf5, PartsOfRowsAreReadAlone) {
  write_ramp(in_folder("a.h5"), 4);
  Hdf5Reader const reader(in_folder("a.h5"));
  std::vector<double> const all = ramp(12);
  std::vector<double> part(2);
  reader.read_box("/group/deeper/ramp", {2, 1}, {1, 2}, part);
  EXPECT_THAT(part, ElementsAre(all[7], all[8]));
}

TEST_F(Hdf5, FullDiskLeavesTheOldFileAndAMessage) {
  std::string const path = in_folder("a.h5");
  write_ramp(path, 1);
  auto const size = fs::file_size(path);
  auto* const handler = signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit const limit{4096, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THAT([&] { write_ramp(path, 10000); }, ThrowsOutputError("a.h5"));
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  EXPECT_EQ(fs::file_size(path), size);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Hdf5, WriterWithoutCloseLeavesNoFile) {
  {
    Hdf5Writer writer(in_folder("a.h5"), origin());
    writer.write("/x", ramp(3), {3}, "1", "x", "x");
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace gladstone
