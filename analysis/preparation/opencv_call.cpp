#include "analysis/preparation/opencv_call.h"

#include <fmt/format.h>

#include <new>
#include <opencv2/core.hpp>

namespace gladstone::inline preparation {

void rethrow_opencv_error(ErrorCode code, std::string const& place, std::string_view task) {
  try {
    throw;
  } catch (cv::Exception const& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw DataError(
        code, place,
        fmt::format(
            "OpenCV cannot {} ({}){}", task, error.err,
            code == ErrorCode::internal ? "; use other images, and report this error with the command line" : ""));
  }
}

}  // namespace gladstone::inline preparation
