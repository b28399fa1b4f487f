#include "render/base/error.h"

#include <gtest/gtest.h>

#include <new>

namespace gladstone {
namespace {

TEST(Error, IsARecordOfPlaceCodeAndMessage) {
  DataError const error(ErrorCode::damaged, "cut.tif", "is cut short");
  EXPECT_EQ(error.code(), ErrorCode::damaged);
  EXPECT_EQ(error.place(), "cut.tif");
  EXPECT_EQ(error.key(), "");
  EXPECT_EQ(error.message(), "is cut short");
  EXPECT_STREQ(error.what(), "cut.tif: is cut short");
}

TEST(Error, HasAKeyIfASetupCausesIt) {
  DataError const error(ErrorCode::out_of_range, KeyPath{"lens.f_number"}, "is too small");
  EXPECT_EQ(error.key(), "lens.f_number");
  EXPECT_STREQ(error.what(), "lens.f_number: is too small");
}

TEST(Error, HasTheCodeOfItsKind) {
  EXPECT_EQ(OutputError("a.tif", "is full").code(), ErrorCode::output);
  EXPECT_EQ(OutputError(ErrorCode::overwrites_input, "a.tif", "is an input").code(), ErrorCode::overwrites_input);
  EXPECT_EQ(DeviceMemoryError("is full").code(), ErrorCode::device);
  EXPECT_EQ(Interrupted().code(), ErrorCode::interrupted);
  EXPECT_EQ(SetupError({{"a.toml:1:1", "is unknown", "a", ErrorCode::unknown_key}}).code(), ErrorCode::unknown_key);
}

TEST(Error, OutOfMemoryIsRecognisedByItsCode) {
  EXPECT_TRUE(is_out_of_memory(DataError(ErrorCode::memory, "a.h5", "is too large")));
  EXPECT_TRUE(is_out_of_memory(SetupError({{"a.toml:1:1", "is too large", "a", ErrorCode::memory}})));
  EXPECT_TRUE(is_out_of_memory(DeviceMemoryError("is too large")));
  EXPECT_TRUE(is_out_of_memory(std::bad_alloc()));
  EXPECT_FALSE(is_out_of_memory(DataError(ErrorCode::damaged, "a.h5", "needs memory")));
}

}  // namespace
}  // namespace gladstone
