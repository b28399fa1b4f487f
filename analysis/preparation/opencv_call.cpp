#include "analysis/preparation/opencv_call.h"

#include <fmt/format.h>

#include <new>
#include <opencv2/core.hpp>

namespace gladstone::inline preparation {

void rethrow_opencv_error(ErrorCode code, std::string_view task) {
  try {
    throw;
  } catch (cv::Exception const& error) {
    if (error.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw DataError(code, "image",
                    fmt::format("OpenCV cannot {} ({}); use other images, and report this error with the command line",
                                task, error.err));
  }
}

}  // namespace gladstone::inline preparation
