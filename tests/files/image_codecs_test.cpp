#include "render/files/image_codecs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "render/files/image_file.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

// A process loads the library once: the test runs in a new process, in which no image has been read.
TEST(ImageCodecs, AreNamedWithTheCureWhereTheyAreMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const read_without = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    std::string const error = error_of([] { loaded_image_codecs(); });
    std::fputs(error.c_str(), stderr);
    std::exit(3);
  };
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3),
              testing::HasSubstr("unreadable_file at libgladstone_image_codecs.so"));
}

TEST(ImageCodecs, AreNamedWithTheImageThatRequiresThem) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const read_without = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    std::string const path = std::filesystem::path(testing::TempDir()) / "no_image.tif";
    std::ofstream(path) << "no image";
    std::string const error = error_of([&] { read_image(path); });
    std::fputs(error.c_str(), stderr);
    std::exit(3);
  };
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("unreadable_file at no_image.tif"));
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
