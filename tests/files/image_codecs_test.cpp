#include "render/files/image_codecs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "render/base/error.h"
#include "render/files/image_file.h"

namespace gladstone {
namespace {

// A process loads the library once: the test runs in a new process, in which no image has been read.
TEST(ImageCodecs, AreNamedWithTheCureWhereTheyAreMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const read_without = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    try {
      image_codecs();
    } catch (DataError const& error) {
      std::fputs(error.what(), stderr);
      std::exit(3);
    }
    std::exit(0);
  };
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("/nowhere/libgladstone_image_codecs.so"));
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("set GLADSTONE_IMAGE_CODECS"));
}

TEST(ImageCodecs, AreNamedWithTheImageThatRequiresThem) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const read_without = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    std::string const path = std::filesystem::path(testing::TempDir()) / "no_image.tif";
    std::ofstream(path) << "no image";
    try {
      read_image(path);
    } catch (DataError const& error) {
      std::fputs(error.what(), stderr);
      std::exit(error.place() == path && error.code() == ErrorCode::unreadable_file ? 3 : 1);
    }
    std::exit(0);
  };
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("pass the array"));
}

TEST(ImageCodecs, AreNotLoadedForTiffsAndWrittenPngs) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const write_and_read = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    std::string const path = std::filesystem::path(testing::TempDir()) / "without_codecs.tif";
    write_tiff(path, Image<std::uint16_t>(2, 3, 7), {});
    encode_png(Image<std::uint8_t>(2, 2));
    std::exit(read_image(path)(1, 2) == 7.0 ? 0 : 1);
  };
  EXPECT_EXIT(write_and_read(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace gladstone
