#include <opencv2/imgproc.hpp>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"

namespace gladstone::inline preparation {

FrameChange make_min_max(int window_px, double least_contrast) {
  return [window_px, least_contrast](PreparedFrames& frames) {
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d& levels, cv::Mat1d const& known) {
      double lowest = 0.0, highest = 0.0;
      cv::minMaxLoc(levels, &lowest, &highest, nullptr, nullptr, known > 0.5);
      if (!(highest > lowest)) return;
      cv::Size const window{window_px, window_px};
      cv::Mat const square = cv::getStructuringElement(cv::MORPH_RECT, window);
      cv::Mat1d low, high;
      cv::erode(levels, low, square);
      cv::dilate(levels, high, square);
      cv::blur(low, low, window);
      cv::blur(high, high, window);
      cv::Mat1d const range = cv::max(high - low, least_contrast * (highest - lowest));
      cv::divide(levels - low, range, levels);
    });
  };
}

}  // namespace gladstone::inline preparation
