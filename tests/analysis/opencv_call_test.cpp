#include "analysis/preparation/opencv_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <new>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

void throw_of_opencv(int code) { throw cv::Exception(code, "reason", "function", "file", 1); }

TEST(OpencvCall, ReturnsTheResult) {
  EXPECT_EQ(call_opencv(ErrorCode::internal, "add", [] { return 1 + 1; }), 2);
}

TEST(OpencvCall, ReportsItsErrorsByTheGivenCode) {
  EXPECT_THAT([] { call_opencv(ErrorCode::unsupported, "add", [] { throw_of_opencv(cv::Error::StsBadSize); }); },
              ThrowsDataError(ErrorCode::unsupported, "image", testing::HasSubstr("reason")));
}

TEST(OpencvCall, ReportsExhaustedMemoryAsAnyAllocation) {
  EXPECT_THROW(call_opencv(ErrorCode::internal, "add", [] { throw_of_opencv(cv::Error::StsNoMem); }), std::bad_alloc);
}

TEST(OpencvCall, KeepsOtherExceptions) {
  EXPECT_THROW(call_opencv(ErrorCode::internal, "add", [] { throw std::out_of_range("other"); }), std::out_of_range);
}

}  // namespace
}  // namespace gladstone
