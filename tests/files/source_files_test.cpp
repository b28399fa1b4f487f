#include "render/files/source_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/output_destination.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Holds = SourceFiles::Holds;

class SourceFilesTest : public Output {
 protected:
  static Image<std::uint16_t> picture() {
    Image<std::uint16_t> image(5, 3);
    for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = static_cast<std::uint16_t>(4000 * i + 7);
    return image;
  }
  void write_datasets(std::string const& name, std::string const& dataset, std::vector<double> const& values,
                      std::vector<std::size_t> const& shape, FileOrigin const& origin = {"test", 1, "", 1, "cpu", {}},
                      double seconds = 1) const {
    Hdf5Writer file(in_folder(name), origin);
    file.write(dataset, std::span<double const>(values), shape, "1", "numbers", "row");
    std::vector<double> const times{seconds};
    file.write("/seconds_render", std::span<double const>(times), {1}, "s", "time", "value");
    file.close();
  }
};

TEST_F(SourceFilesTest, PixelsHaveOneHashWhateverTheFileSaysBesides) {
  write_tiff(in_folder("a.tif"), picture(), {16, 1e-5, "one setup"});
  write_tiff(in_folder("b.tif"), picture(), {12, 0, "another"});
  EXPECT_NE(content(in_folder("a.tif")), content(in_folder("b.tif")));
  std::string const hash = pixel_sha256(picture());
  EXPECT_EQ(hash.size(), 64u);
  EXPECT_EQ(pixel_sha256(in_folder("a.tif")), hash);
  EXPECT_EQ(pixel_sha256(in_folder("b.tif")), hash);
}

TEST_F(SourceFilesTest, EveryPixelSizeAndDepthCounts) {
  auto const same = picture();
  std::string const hash = pixel_sha256(same);
  for (std::size_t i = 0; i < same.size(); ++i) {
    auto changed = same;
    ++changed.data()[i];
    EXPECT_NE(pixel_sha256(changed), hash) << i;
  }
  Image<std::uint16_t> turned(3, 5);
  std::copy(same.begin(), same.end(), turned.begin());
  EXPECT_NE(pixel_sha256(turned), hash);
  Image<double> real(5, 3);
  std::copy(same.begin(), same.end(), real.begin());
  EXPECT_EQ(pixel_sha256(real, 16), hash);
  EXPECT_NE(pixel_sha256(real, 8), hash);
  real(2, 1) += 0.25;  // value of a floating-point image
  std::string const finer = pixel_sha256(real, 32);
  real(2, 1) = std::nextafter(real(2, 1), 0.0);
  EXPECT_NE(pixel_sha256(real, 32), finer);
}

TEST_F(SourceFilesTest, DatasetsHaveOneHashWhateverTheDateAndTheDevice) {
  write_datasets("a.h5", "/g/x", {1, 2, 3, 4}, {4});
  write_datasets("b.h5", "/g/x", {1, 2, 3, 4}, {4}, {"other", 2, "setup", 3, "cuda", {}}, 7.5);
  EXPECT_EQ(dataset_sha256(in_folder("a.h5")), dataset_sha256(in_folder("b.h5")));
  write_datasets("c.h5", "/g/x", {1, 2, 3, 5}, {4});
  write_datasets("d.h5", "/g/x", {1, 2, 3, 4}, {2, 2});
  write_datasets("e.h5", "/g/y", {1, 2, 3, 4}, {4});
  write_datasets("f.h5", "/g/x", {}, {0});
  for (char const* other : {"c.h5", "d.h5", "e.h5", "f.h5"}) {
    EXPECT_NE(dataset_sha256(in_folder("a.h5")), dataset_sha256(in_folder(other))) << other;
  }
}

TEST_F(SourceFilesTest, LongDatasetsAreReadPieceByPieceToTheirLastValue) {
  std::vector<double> values((std::size_t{1} << 20) + 3);
  write_datasets("a.h5", "/x", values, {values.size()});
  values.back() = 1;
  write_datasets("b.h5", "/x", values, {values.size()});
  EXPECT_NE(dataset_sha256(in_folder("a.h5")), dataset_sha256(in_folder("b.h5")));
}

TEST_F(SourceFilesTest, AFileThatHoldsSomethingElseIsNamedWithWhatToDo) {
  write_tiff(in_folder("a.tif"), picture(), {});
  write("rays.csv", "1,2\n");
  SourceFiles sources;
  sources.on_change("run it again");
  sources.add("frame", in_folder("a.tif"), Holds::pixels);
  sources.add("", in_folder("rays.csv"), Holds::bytes);
  EXPECT_EQ(sources.sha256("frame"), pixel_sha256(picture()));
  sources.check();
  write_tiff(in_folder("a.tif"), picture(), {16, 1e-5, "another text"});
  sources.check();
  write("rays.csv", "1,3\n");
  EXPECT_THAT([&] { sources.check(); }, ThrowsDataError(ErrorCode::changed, "rays.csv"));
  write("rays.csv", "1,2\n");
  fs::remove(in_folder("a.tif"));
  EXPECT_THAT([&] { sources.check(); }, ThrowsDataError(ErrorCode::changed, "a.tif"));
}

// An image that is added under two names is decoded once: both names have the hash of what was read first.
TEST_F(SourceFilesTest, AnImageIsReadOnce) {
  std::string const file = in_folder("a.tif");
  Image<std::uint16_t> written = picture();
  write_tiff(file, written, {});
  SourceFiles sources;
  Image<double> const image = sources.add_image("frame", file);
  EXPECT_TRUE(std::equal(image.begin(), image.end(), written.begin(), written.end()));
  EXPECT_EQ(sources.sha256("frame"), pixel_sha256(written));
  sources.check();
  ++written(0, 0);
  write_tiff(file, written, {});
  sources.add("again", file, Holds::pixels);
  EXPECT_EQ(sources.sha256("again"), sources.sha256("frame"));
  EXPECT_THAT([&] { sources.check(); }, ThrowsDataError(ErrorCode::changed, "a.tif"));
}

TEST_F(SourceFilesTest, AnHdf5FileNamesItsSourcesAndIsNotWrittenWhereTheyChange) {
  write("rays.csv", "1,2\n");
  FileOrigin origin{"test", 1, "", 1, "cpu", {}};
  origin.sources.add("rays", in_folder("rays.csv"), Holds::bytes);
  origin.sources.add_known("flow", "0123");
  write_datasets("a.h5", "/x", {1}, {1}, origin);
  EXPECT_EQ(Hdf5Reader(in_folder("a.h5")).attribute("rays_sha256"), byte_sha256(in_folder("rays.csv")));
  EXPECT_EQ(Hdf5Reader(in_folder("a.h5")).attribute("flow_sha256"), "0123");
  write("rays.csv", "1,3\n");
  EXPECT_THAT([&] { write_datasets("b.h5", "/x", {1}, {1}, origin); }, ThrowsDataError(ErrorCode::changed, "rays.csv"));
  EXPECT_THAT(names(), testing::ElementsAre("a.h5", "rays.csv"));
}

TEST_F(SourceFilesTest, RefusesPipesAndDevices) {
  ASSERT_EQ(mkfifo(in_folder("pipe").c_str(), 0666), 0);
  EXPECT_THAT([&] { byte_sha256(in_folder("pipe")); }, ThrowsDataError(ErrorCode::unreadable_file, "pipe"));
  EXPECT_THAT([] { byte_sha256("/dev/zero"); }, ThrowsDataError(ErrorCode::unreadable_file, "/dev/zero"));
}

TEST_F(SourceFilesTest, AnOutputIsNoInputUnderAnyName) {
  write("rays.csv", "1,2\n");
  fs::create_symlink("rays.csv", in_folder("link.csv"));
  fs::create_hard_link(in_folder("rays.csv"), in_folder("hard.csv"));
  fs::create_directory_symlink(".", in_folder("again"));
  for (std::string const name : {"rays.csv", "link.csv", "hard.csv", "again/rays.csv", "./again/again/rays.csv"}) {
    EXPECT_THAT([&] { refuse_inputs_as_outputs({in_folder(name)}, {in_folder("rays.csv")}); },
                ThrowsOutputError(name, ErrorCode::overwrites_input))
        << name;
  }
  refuse_inputs_as_outputs({in_folder("new.csv"), in_folder("again/new.csv")},
                           {in_folder("rays.csv"), in_folder("no")});
}

}  // namespace
}  // namespace gladstone
