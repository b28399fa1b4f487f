#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "analysis/preparation/frame_changes.h"
#include "analysis/preparation/grey_levels.h"

namespace gladstone::inline preparation {

FrameChange make_clahe(int tile_px, double clip_limit) {
  return [tile_px, clip_limit](PreparedFrames& frames) {
    for_both<cv::Mat1d>(frames, [&](cv::Mat1d& levels, cv::Mat1d const& known) {
      double low = 0.0, high = 0.0;
      cv::minMaxLoc(levels, &low, &high, nullptr, nullptr, known > 0.5);
      if (!(high > low)) return;
      cv::Mat whole;
      levels.convertTo(whole, CV_16U, 65535.0 / (high - low), -65535.0 * low / (high - low));
      cv::Size const tiles{std::max(1, levels.cols / tile_px), std::max(1, levels.rows / tile_px)};
      cv::createCLAHE(clip_limit, tiles)->apply(whole, whole);
      whole.convertTo(levels, CV_64F);
    });
  };
}

}  // namespace gladstone::inline preparation
