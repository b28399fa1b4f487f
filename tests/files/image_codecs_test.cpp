#include "render/files/image_codecs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "render/base/error.h"
#include "render/files/image_file.h"

namespace gladstone {
namespace {

// The library is searched for once per process. The test therefore restarts itself as a process in which no image has
// been read.
TEST(ImageCodecs, AreNamedWithTheCureWhereTheyAreMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  auto const read_without = [] {
    setenv("GLADSTONE_IMAGE_CODECS", "/nowhere", 1);
    try {
      write_tiff("never.tif", Image<std::uint16_t>(2, 2), {});
    } catch (DataError const& error) {
      std::fputs(error.what(), stderr);
      std::exit(3);
    }
    std::exit(0);
  };
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("/nowhere/libgladstone_image_codecs.so"));
  EXPECT_EXIT(read_without(), testing::ExitedWithCode(3), testing::HasSubstr("set GLADSTONE_IMAGE_CODECS"));
}

}  // namespace
}  // namespace gladstone
