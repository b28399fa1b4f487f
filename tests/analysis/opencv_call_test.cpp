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
  EXPECT_EQ(call_opencv(ErrorCode::internal, "image", "add", [] { return 1 + 1; }), 2);
}

TEST(OpencvCall, ReportsItsErrorsByTheGivenCode) {
  auto const fail = [](ErrorCode code, char const* place) {
    return [=] { call_opencv(code, place, "add", [] { throw_of_opencv(cv::Error::StsBadSize); }); };
  };
  auto const asks_for_a_report = testing::HasSubstr("report");
  EXPECT_THAT(fail(ErrorCode::internal, "image"), ThrowsDataError(ErrorCode::internal, "image", asks_for_a_report));
  EXPECT_THAT(fail(ErrorCode::unsupported, "image pair"),
              ThrowsDataError(ErrorCode::unsupported, "image pair",
                              testing::AllOf(testing::HasSubstr("reason"), testing::Not(asks_for_a_report))));
}

TEST(OpencvCall, ReportsExhaustedMemoryAsAnyAllocation) {
  EXPECT_THROW(call_opencv(ErrorCode::internal, "image", "add", [] { throw_of_opencv(cv::Error::StsNoMem); }),
               std::bad_alloc);
}

TEST(OpencvCall, KeepsOtherExceptions) {
  EXPECT_THROW(call_opencv(ErrorCode::internal, "image", "add", [] { throw std::out_of_range("other"); }),
               std::out_of_range);
}

}  // namespace
}  // namespace gladstone
